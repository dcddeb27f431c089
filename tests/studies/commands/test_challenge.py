"""`tsas challenge` in a process of its own, with every warning an error."""

import json
import re
from pathlib import Path
from typing import get_args

import pytest

from tests.studies.challenge.made import case, diagnosis, write_entry, write_set
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.errors import InputError
from tsas_studies.challenge import cases
from tsas_studies.challenge.entry import read_entry
from tsas_studies.challenge.run import TOOLS
from tsas_studies.challenge.targets import TARGETS
from tsas_studies.challenge.truth import read_truth
from tsas_studies.commands.challenge import Conditions, Kind, Tool, make, run, score

DOCS = (Path(__file__).parents[3] / "docs" / "challenge.md").read_text(encoding="utf-8")


@pytest.fixture
def sealed(tmp_path):
    return write_set(tmp_path / "set", {"a": case("backlash"), "b": case()})


@pytest.fixture
def entry(tmp_path):
    return write_entry(tmp_path / "mine", {"a": diagnosis("backlash"), "b": diagnosis()})


def test_what_is_printed_is_what_is_written_and_documented(strict, sealed, entry, tmp_path):
    done = strict("challenge", "score", sealed, entry, "--out", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    content = json.loads((tmp_path / "out" / "score.json").read_text(encoding="utf-8"))
    assert json.loads(done.stdout) == content
    (mine,) = content["entries"].values()
    assert mine["cases"]["a"] == {"outcome": "exact", "named_falsely": []}
    section = DOCS.split("## score.json")[1].split("\n## ")[0]
    told = set(re.findall(r"`(\w+)`", section))
    assert content.keys() | content["answers"].keys() | mine.keys() <= told
    (figure,) = re.findall(r"`\{(.*?)\}`", section)
    assert list(mine["figures"][0]) == figure.split(", ")
    text = strict("challenge", "score", sealed, entry)
    assert (text.returncode, text.stderr) == (0, "")
    assert re.search(
        r"the worst effect +≥ 95 % for each effect +1 of 1, backlash +yes", text.stdout
    )


def test_the_documented_targets_are_those_that_count():
    section = DOCS.split("| figure | target |")[1].split("\n\n")[0]
    bounds = (bound for target in TARGETS.values() for bound in (target.low, target.high))
    meant = [f"{100 * bound:g}" for bound in bounds if 0.0 < bound < 1.0]
    targets = " ".join(row.split("|")[2] for row in section.splitlines()[2:])
    assert re.findall(r"\d+", targets) == meant


def test_the_documented_files_are_read(tmp_path):
    blocks = re.findall(r"```json\n(.*?)```", DOCS, re.DOTALL)
    answers, said = map(json.loads, blocks)
    (tmp_path / "answers.json").write_text(json.dumps(answers), encoding="utf-8")
    (name,) = answers["cases"]
    assert read_truth(tmp_path).cases[name].effects == {"backlash"}
    entry = read_entry(write_entry(tmp_path / "entry", {name: said}), [name])
    (named,) = entry.diagnoses[name].named
    assert named.parameters["play_mm"].interval == pytest.approx((0.11408, 0.12192))


def test_a_set_is_made_scored_and_not_overwritten_unasked(monkeypatch, capsys, tmp_path):
    """Two cases stand for all of a seed, which take minutes."""
    few = cases.cases(17)[:2]
    monkeypatch.setattr(cases, "cases", lambda seed, salt: {17: few}[seed])
    make(tmp_path / "set", seed=17, rate=25.0, as_json=True)
    summary = json.loads(capsys.readouterr().out)
    assert (summary["seed"], summary["cases"]) == (17, {"one": 2})
    answers = read_truth(tmp_path / "set")
    assert answers.seed == 17
    for name in answers.cases:
        assert len(list(read_dataset(tmp_path / "set" / "cases" / name / "dataset"))) == 4
    right = {name: diagnosis(*case.effects) for name, case in answers.cases.items()}
    score(tmp_path / "set", [write_entry(tmp_path / "entry", right)], as_json=True)
    (entry,) = json.loads(capsys.readouterr().out)["entries"].values()
    assert {case["outcome"] for case in entry["cases"].values()} == {"exact"}
    with pytest.raises(InputError, match="already exists"):
        make(tmp_path / "set", seed=17, rate=25.0)


def test_cases_of_one_kind_and_condition_of_several_seeds_are_a_set(monkeypatch, capsys, tmp_path):
    few = {
        seed: [c for c in cases.cases(seed) if c.kind == "pair" or c.name.startswith("nothing 10")]
        for seed in (17, 18)
    }
    monkeypatch.setattr(cases, "cases", lambda seed, salt: few[seed])
    chosen = {"kind": "nothing", "conditions": "realistic", "rate": 25.0}
    make(tmp_path / "set", seed=17, seeds=2, **chosen)
    assert "2 cases of seeds 17 to 18" in capsys.readouterr().out
    assert read_truth(tmp_path / "set").seed == (17, 18)
    said = {name: diagnosis() for name in read_truth(tmp_path / "set").cases}
    score(tmp_path / "set", [write_entry(tmp_path / "entry", said)])
    assert "set of seeds 17, 18: 2 realistic nothing" in capsys.readouterr().out
    with pytest.raises(InputError, match="no case is of this kind"):
        make(tmp_path / "none", seed=17, small=True, kind="pair", rate=25.0)
    assert not (tmp_path / "none").exists()


def test_every_kind_can_be_asked_for():
    listed = cases.cases(17)
    assert set(get_args(Kind)) == {c.kind for c in listed}
    assert set(get_args(Conditions)) == {c.conditions for c in listed}


def test_every_tool_can_be_asked_for():
    assert list(get_args(Tool)) == list(TOOLS)
    section = DOCS.split("## Baselines")[1].split("\n## ")[0]
    assert all(f"| `{name}` |" in section for name in TOOLS if name != "diagnose")


def test_a_folder_that_is_no_set(entry, tmp_path):
    for call in (
        lambda: run(tmp_path / "none", out=tmp_path / "out"),
        lambda: score(tmp_path / "none", [entry], out=tmp_path / "out"),
    ):
        with pytest.raises(InputError, match="`tsas challenge make`"):
            call()
    assert not (tmp_path / "out").exists()
