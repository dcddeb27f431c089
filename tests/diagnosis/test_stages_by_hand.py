"""What the stages do around a plan and a drive, on plans and drives that are made up."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.test_rig_file import TEXT
from tsas_cli.diagnosis.plan import Plan
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.identification.estimate import Estimate
from tsas_cli.recordings.manifest import Run
from tsas_cli.stages import identify_harmonic_drive as drive_stage
from tsas_cli.stages import plan as plan_stage
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of

NOTHING = Plan((), (), (), ("nobody knows.",))


@pytest.fixture
def rig(tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(plan_stage, "plan_rig", lambda file, step: asked.append(file) or NOTHING)
    path = tmp_path / "rig.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path, asked


def test_a_rig_file_is_planned_and_written(rig, tmp_path):
    path, asked = rig
    result = plan_stage.plan(path, out=tmp_path / "deep" / "out")
    assert [file.name for file in asked] == ["bench"]
    written = json.loads((tmp_path / "deep" / "out" / "plan.json").read_text())
    assert written == result.summary
    assert (written["format"], written["stage"]) == (1, "plan")
    assert written["rig"] == {
        "name": "bench",
        "file": "../../rig.toml",
        "sha256": sha256_of(path),
    }
    assert result.plan is NOTHING
    assert "nobody knows." in repr(result)


def test_without_a_folder_nothing_is_written_and_with_one_nothing_is_overwritten(rig, tmp_path):
    path, _ = rig
    before = sorted(tmp_path.rglob("*"))
    assert plan_stage.plan(path).out is None
    assert sorted(tmp_path.rglob("*")) == before
    plan_stage.plan(path, out=tmp_path / "out")
    with pytest.raises(InputError):
        plan_stage.plan(path, out=tmp_path / "out")
    plan_stage.plan(path, out=tmp_path / "out", force=True)


def test_what_the_data_sheet_gives_is_given():
    sheet = DataSheet(27.1, None, 0.13, 2.3)
    found = drive_stage._given(sheet)
    assert {n: (e.value, e.origin) for n, e in found.items()} == {
        "turntable_radius_mm": (27.1, "data sheet"),
        "inertia_N_mm_s2": (0.13, "data sheet"),
    }


def test_simulated_runs_stand_beside_each_other():
    """Each run by the final and by the nominal terms, under its own name."""
    values = {"final": 10.0, "nominal": 20.0}
    runs = [SimpleNamespace(time_s=np.arange(2.0)), SimpleNamespace(time_s=np.arange(3.0))]
    bench = SimpleNamespace(runs=runs, simulated=lambda r, value: np.full(r + 2, value + r))
    search = SimpleNamespace(bench=bench, trial=lambda t: SimpleNamespace(values=values[t]))
    fitted = drive_stage._simulated(search, "final")
    nominal = drive_stage._simulated(search, "nominal")
    entries = [Run(id=i, file=i, sha256="0" * 64) for i in ("a", "b")]
    found = drive_stage._recordings(entries, search, fitted, nominal)
    assert list(found) == ["a", "b"]
    assert found["b"].run.id == "b"
    columns = {name: values.tolist() for name, values in found["b"].columns.items()}
    assert columns == {
        "time_s": [0.0, 1.0, 2.0],
        "x_in_mm": [11.0] * 3,
        "x_in_nominal_mm": [21.0] * 3,
    }
    with pytest.raises(ValueError, match="zip"):
        drive_stage._recordings(entries[:1], search, fitted, nominal)


def test_a_drive_is_made_of_what_is_finite(monkeypatch):
    monkeypatch.setattr(drive_stage, "drive_of", dict)
    known = {
        "gain": Estimate("gain", 0.02, "", "fitted"),
        "frequency": Estimate("frequency", math.inf, "Hz", "fitted"),
    }
    result = drive_stage.DriveResult({}, None, known, None, {})
    assert result.drive == {"gain": 0.02}
