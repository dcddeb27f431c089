"""`tsas reproduce` in a process of its own, with every warning an error."""

import json
from pathlib import Path

import pytest

from tests.commands.documented import documented
from tsas_studies.reproduction import GROUPS
from tsas_studies.reproduction.group import VERDICTS

DOCS = Path(__file__).parents[3] / "docs" / "paper.md"


@pytest.mark.slow
def test_it_writes_what_is_documented_and_the_same_again(strict, tmp_path):
    done = strict("reproduce", "--out", tmp_path / "one")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1].startswith("Of ")
    again = strict("reproduce", "--out", tmp_path / "two", "--json")
    written = (tmp_path / "one" / "reproduction.json").read_text(encoding="utf-8")
    summary = json.loads(written)
    assert again.stdout == written
    assert set(summary) == documented("reproduction.json")
    assert summary["counts"] == {
        verdict: sum(group["counts"][verdict] for group in summary["groups"])
        for verdict in VERDICTS
    }
    assert len(summary["groups"]) == len(GROUPS)
    for group in summary["groups"]:
        for row in group["rows"]:
            assert row["evidence"]
            assert bool(row["because"]) == (row["verdict"] != "agrees")
            assert bool(row["criterion"]) == (row["verdict"] != "cannot tell")
    for group in summary["groups"]:
        counts = " | ".join(str(group["counts"][verdict]) for verdict in VERDICTS)
        assert f"| {group['title']} | {counts} |" in DOCS.read_text(encoding="utf-8")
    pages = [(tmp_path / name / "index.html").read_bytes() for name in ("one", "two")]
    assert pages[0] == pages[1]
    assert pages[0].startswith(b"<!DOCTYPE html>")


def test_a_folder_that_is_there_stays_without_force(strict, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine").write_text("mine", encoding="utf-8")
    done = strict("reproduce", "--out", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "--force" in done.stderr
    assert [path.name for path in out.iterdir()] == ["mine"]
