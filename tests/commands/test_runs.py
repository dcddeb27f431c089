import json
import os

import pytest

from tests.collection.collected import write


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("TSAS_CACHE_DIR", str(tmp_path / "cache"))
    write(tmp_path / "rigs" / "a", {"total_bend_rad": 3.5}, {"total_bend_rad": 1.0})
    write(tmp_path / "rigs" / "b c", {"total_bend_rad": 4.0})
    return tmp_path


def test_a_table_of_the_runs(done, home):
    call = ("runs", "total_bend_rad > 3", "--in", "rigs", "--columns", "folder,run,total_bend_rad")
    assert done(*call, cwd=home).splitlines() == [
        "2 of 3 runs",
        "  folder    run  total_bend_rad",
        "  --------  ---  --------------",
        "  rigs/a    r0   3.5",
        "  rigs/b c  r0   4",
        "",
    ]


def test_json_and_paths(here, home, monkeypatch):
    monkeypatch.chdir(home)
    call = ("runs", "--in", "rigs")
    content = json.loads(here(*call, "--sort", "-total_bend_rad", "--json")[1])
    assert [row["total_bend_rad"] for row in content["runs"]] == [4.0, 3.5, 1.0]
    assert here(*call, "--paths") == (0, "rigs/a\nrigs/b c\n", "")
    assert here(*call, "--quiet") == (0, "", "")


def test_errors_are_one_line(refused_here, home, monkeypatch):
    monkeypatch.chdir(home)
    said = refused_here("runs", "bend > 3")
    assert said.startswith("tsas: the query, character 1, at 'bend > 3': there is no column")
    refused_here("runs", "--paths", "--json")


def test_without_duckdb_the_line_says_what_to_install(tsas, tmp_path):
    (tmp_path / "duckdb.py").write_text("raise ImportError('hidden')")
    found = tsas("runs", env=os.environ | {"PYTHONPATH": str(tmp_path)})
    assert (found.returncode, found.stderr.count("\n")) == (2, 1)
    assert "queries need the package duckdb; install tsas[catalogue]" in found.stderr
