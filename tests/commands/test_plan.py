"""`tsas plan`, with every warning an error."""

import json
import re
from pathlib import Path

import pytest

from tsas_cli.diagnosis import plan as planning
from tsas_cli.diagnosis.candidates import candidates
from tsas_cli.effects import EFFECTS
from tsas_cli.support.files import sha256_of
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

DOCS = Path(__file__).parents[2] / "docs" / "plan.md"
FEW = ("a fast sine", "another preload")


@pytest.fixture
def rig_file(tmp_path):
    """Return the example of docs/plan.md as a file."""
    text = DOCS.read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    path = tmp_path / "rig.toml"
    path.write_text(text.replace("rate_Hz = 200", "rate_Hz = 40"), encoding="utf-8")
    return path


def documented():
    section = DOCS.read_text(encoding="utf-8").split("## plan.json")[1]
    rows = re.findall(r"^\| (`.*?) \|", section, flags=re.MULTILINE)
    return {key for row in rows for key in re.findall(r"`(\w+)`", row)}


def is_documented(summary, rig_file, out):
    assert json.loads((out / "plan.json").read_text(encoding="utf-8")) == summary
    assert set(summary) == documented() - {"dataset"}
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
def test_it_writes_what_is_documented_of_all_runs(strict, rig_file, tmp_path):
    done = strict("plan", rig_file, "--out", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    is_documented(json.loads(done.stdout), rig_file, tmp_path / "out")


@pytest.mark.large
def test_a_dataset_is_planned_from_too(strict, tmp_path):
    recorded = record(Rig(), motion=sine(omega_rad_s=1.0), sensors=Sensors(rate_Hz=100.0))
    folder = write_dataset(tmp_path / "d", [Run("a", recorded, conditions(Rig()))])
    done = strict("plan", folder)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0].startswith("smallest size of each effect")
    assert any(re.match(r"  load_inertia +mass_kg +kg ", line) for line in lines)
    assert any(line.startswith("add ") for line in lines)


def test_a_slip_in_the_file_is_one_line(strict, rig_file, tmp_path):
    text = rig_file.read_text(encoding="utf-8")
    rig_file.write_text(text.replace("preload_N = 25.0", "preload_n = 25.0"), encoding="utf-8")
    done = strict("plan", rig_file, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "preload_N is missing" in done.stderr
    assert not (tmp_path / "out").exists()
