"""`tsas reproduce`: what it writes, of two quick groups and, as a large test, of all."""

import json
from pathlib import Path

import pytest

from tests.commands.documented import documented
from tsas_studies.reproduction import GROUPS, reproduce
from tsas_studies.reproduction.contradictions import contradictions
from tsas_studies.reproduction.group import VERDICTS
from tsas_studies.reproduction.tables_1_2_4 import tables_1_2_4

DOCS = Path(__file__).parents[3] / "docs" / "paper.md"


def groups_of(folders, printed):
    """Return the groups that two calls have written alike; the second one has printed them."""
    one, two = folders
    written = (one / "reproduction.json").read_text(encoding="utf-8")
    assert printed == written
    found = json.loads(written)
    assert set(found) == documented("reproduction.json")
    assert found["counts"] == {
        verdict: sum(group["counts"][verdict] for group in found["groups"]) for verdict in VERDICTS
    }
    for group in found["groups"]:
        for row in group["rows"]:
            assert row["evidence"]
            assert bool(row["because"]) == (row["verdict"] != "agrees")
            assert bool(row["criterion"]) == (row["verdict"] != "cannot tell")
        counts = " | ".join(str(group["counts"][verdict]) for verdict in VERDICTS)
        assert f"| {group['title']} | {counts} |" in DOCS.read_text(encoding="utf-8")
    pages = [(folder / "index.html").read_bytes() for folder in (one, two)]
    assert pages[0] == pages[1]
    assert pages[0].startswith(b"<!DOCTYPE html>")
    return found["groups"]


def test_it_writes_what_is_documented_and_the_same_again(tmp_path, monkeypatch, here):
    monkeypatch.setattr(reproduce, "GROUPS", (tables_1_2_4, contradictions))
    folders = (tmp_path / "one", tmp_path / "two")
    printed = []
    for folder, more in zip(folders, ([], ["--json"]), strict=True):
        code, out, _ = here("reproduce", "--out", folder, *more)
        assert code == 0
        printed.append(out)
    assert printed[0].splitlines()[-1].startswith("Of ")
    assert len(groups_of(folders, printed[1])) == 2


@pytest.mark.large
def test_all_groups_are_written_as_documented_and_the_same_again(strict, tmp_path):
    folders = (tmp_path / "one", tmp_path / "two")
    done = strict("reproduce", "--out", folders[0])
    assert (done.returncode, done.stderr) == (0, "")
    again = strict("reproduce", "--out", folders[1], "--json")
    assert len(groups_of(folders, again.stdout)) == len(GROUPS)


def test_a_folder_that_is_there_stays_without_force(strict, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine").write_text("mine", encoding="utf-8")
    done = strict("reproduce", "--out", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "--force" in done.stderr
    assert [path.name for path in out.iterdir()] == ["mine"]
