"""`tsas identify-harmonic-drive` in a process of its own, with every warning an error."""

import json
import tomllib
from pathlib import Path

import pytest

from tests.commands.documented import documented
from tests.drives import DATA_SHEET, STIFF, columns, speeds
from tsas_cli.drive.file import read_drive
from tsas_studies.challenge.rig.drive import Gear
from tsas_studies.challenge.rig.recordings import Run, write_dataset

SHIPPED = Path(__file__).parents[2] / "datasets" / "drive-chirp"


@pytest.fixture(scope="module")
def recorded():
    t, u = speeds(duration_s=2.5)["sines"]
    return columns(STIFF, Gear(), t, u, seed=1)


def identified(done, dataset, out):
    """Return what is printed, which is what is written."""
    summary = json.loads(done("identify-harmonic-drive", dataset, "--out", out, "--json"))
    assert json.loads((out / "drive.json").read_text(encoding="utf-8")) == summary
    return summary


def test_it_writes_what_is_documented(done, recorded, tmp_path):
    dataset = write_dataset(tmp_path / "dataset", [Run("a", recorded)], data_sheet=DATA_SHEET)
    summary = identified(done, dataset, tmp_path / "out")
    assert set(summary) == documented("drive.json")
    assert summary["diagnosis"]["verdict"] == "sufficient"
    assert read_drive(tmp_path / "out").turntable_radius_mm == 27.1


@pytest.mark.large  # tests/stages names and sizes the same each time, of smaller recordings
def test_the_worked_case(done, tmp_path):
    """Yang's Eq. (25) on a drive whose stiffness reacts: the reaction is what it lacks."""
    summary = identified(done, SHIPPED, tmp_path / "out")
    truth = tomllib.loads((SHIPPED / "truth.toml").read_text(encoding="utf-8"))
    parameters = {p["name"]: p for p in summary["parameters"]}
    springs = ("drive_stiffness_N_per_mm", "pull_back_N_per_mm", "damping_N_s_per_mm")
    for name in (*springs, "motor_lag_s"):
        value = truth[name]
        assert parameters[name]["interval_low"] < value < parameters[name]["interval_high"], name
        assert parameters[name]["stderr"] < 0.01 * value
    found = summary["diagnosis"]
    assert found["verdict"] == "named"
    assert found["nominal"] == "Eq. (25) without reaction"
    assert [c["effect"] for c in found["named"]] == ["drive_compliance", "channel_delay"]
    channel = found["channels"]["x_in_mm"]
    assert channel["rmse_before"] > 10.0 * channel["rmse_after"]
    assert channel["rmse_after"] == pytest.approx(0.005, rel=0.03)
    lead = summary["kinematics"]
    assert lead["kinematic_lead_rpm_s_per_mm"] == pytest.approx(42.2847, abs=1e-3)
    assert lead["fitted_lead_rpm_s_per_mm"] == pytest.approx(44.19, abs=0.01)
    drive = read_drive(tmp_path / "out")
    assert drive.kA_rpm_s2_per_mm == pytest.approx(44.19 * (0.002 + 0.007 / 54.34), rel=2e-3)


def test_what_does_not_serve_is_refused_in_one_line(refused, recorded, tmp_path):
    made = {n.replace("motor_speed_rpm", "f_in_N"): v for n, v in recorded.items()}
    folder = write_dataset(tmp_path / "dataset", [Run("a", made)], data_sheet=DATA_SHEET)
    said = refused("identify-harmonic-drive", folder, "--out", tmp_path / "out")
    assert "column motor_speed_rpm is missing" in said
    assert "runs/a.parquet" in said
    assert not (tmp_path / "out").exists()
