"""`tsas plan`, with every warning an error."""

import json
import re

import pytest

from tests.commands.documented import DOCS, documented
from tests.rigs import dataset_of, recorded
from tsas_cli.diagnosis import plan as planning
from tsas_cli.diagnosis.candidates import candidates
from tsas_cli.effects import EFFECTS
from tsas_cli.support.files import sha256_of
from tsas_studies.challenge.rig.tendon import Rig

FEW = ("a fast sine", "another preload")


@pytest.fixture
def rig_file(tmp_path):
    """Return the example of docs/plan.md as a file."""
    text = (DOCS / "plan.md").read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    path = tmp_path / "rig.toml"
    path.write_text(text.replace("rate_Hz = 200", "rate_Hz = 40"), encoding="utf-8")
    return path


def is_documented(summary, rig_file, out):
    assert json.loads((out / "plan.json").read_text(encoding="utf-8")) == summary
    assert set(summary) == documented("plan.json", "plan.md") - {"dataset"}
    assert summary["rig"]["name"] == "bench-42"
    assert (out / summary["rig"]["file"]).resolve() == rig_file.resolve()
    assert summary["rig"]["sha256"] == sha256_of(rig_file)
    parameters = [(row["effect"], row["parameter"]) for row in summary["effects"]]
    assert parameters == [(e.name, p.name) for e in EFFECTS for p in e.parameters if not p.shape]
    for row in summary["effects"]:
        if row["named_from"] is not None:
            assert row["found_from"] <= row["named_from"]
    assert summary["proposals"]
    for proposal in summary["proposals"]:
        run = proposal["run"]
        assert run["amplitude_mm"] <= 10.0
        assert run["speed_mm_per_s"] <= 40.0
        assert run["preload_N"] in (15.0, 25.0, 40.0)


def test_it_writes_what_is_documented(rig_file, tmp_path, monkeypatch, here):
    """In this process, with few runs that might be added."""

    def few(*asked):
        return [one for one in candidates(*asked) if one.title in FEW]

    monkeypatch.setattr(planning, "candidates", few)
    code, said, talk = here("plan", rig_file, "--out", tmp_path / "out", "--json")
    assert (code, talk) == (0, "")
    is_documented(json.loads(said), rig_file, tmp_path / "out")


@pytest.mark.large
def test_it_writes_what_is_documented_of_all_runs(done, rig_file, tmp_path):
    said = done("plan", rig_file, "--out", tmp_path / "out", "--json")
    is_documented(json.loads(said), rig_file, tmp_path / "out")


@pytest.mark.large
def test_a_dataset_is_planned_from_too(done, tmp_path):
    lines = done("plan", dataset_of(Rig(), tmp_path / "d", a=recorded(Rig()))).splitlines()
    assert lines[0].startswith("smallest size of each effect")
    assert any(re.match(r"  load_inertia +mass_kg +kg ", line) for line in lines)
    assert any(line.startswith("add ") for line in lines)


def test_a_slip_in_the_file_is_one_line(refused, rig_file, tmp_path):
    text = rig_file.read_text(encoding="utf-8")
    rig_file.write_text(text.replace("preload_N = 25.0", "preload_n = 25.0"), encoding="utf-8")
    assert "preload_N is missing" in refused("plan", rig_file, "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()
