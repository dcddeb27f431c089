import json

import pytest

from tests.collection.collected import write


@pytest.fixture
def call(tsas, tmp_path, monkeypatch):
    monkeypatch.setenv("TSAS_CACHE_DIR", str(tmp_path / "cache"))
    write(tmp_path / "rigs" / "a", {"total_bend_rad": 3.5}, {"total_bend_rad": 1.0})
    write(tmp_path / "rigs" / "b c", {"total_bend_rad": 4.0})
    return lambda *arguments: tsas("runs", *arguments, cwd=tmp_path)


def test_a_table_of_the_runs(call):
    done = call("total_bend_rad > 3", "--in", "rigs", "--columns", "folder,run,total_bend_rad")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines() == [
        "2 of 3 runs",
        "  folder    run  total_bend_rad",
        "  --------  ---  --------------",
        "  rigs/a    r0   3.5",
        "  rigs/b c  r0   4",
        "",
    ]


def test_json_and_paths(call):
    done = call("--in", "rigs", "--sort", "-total_bend_rad", "--json")
    content = json.loads(done.stdout)
    assert [row["total_bend_rad"] for row in content["runs"]] == [4.0, 3.5, 1.0]
    assert call("--in", "rigs", "--paths").stdout == "rigs/a\nrigs/b c\n"
    assert call("--in", "rigs", "--quiet").stdout == ""


def test_errors_are_one_line(call):
    done = call("bend > 3")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("tsas: the query, character 1, at 'bend > 3': there is no column")
    assert done.stderr.count("\n") == 1
    assert call("--paths", "--json").returncode == 2
