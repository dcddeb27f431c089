"""The same of shipped recordings, and of a drive: other units and another clock say the same."""

from pathlib import Path

import numpy as np
import pytest

import tsas_cli as tsas
from tests.drives import LAGGING, drive_dataset
from tests.metamorphic.answers import Answers, apart, largest
from tests.metamorphic.raw import CLOCK, IMPERIAL, Raw, in_units, later

SHIPPED = Path(__file__).parents[2] / "datasets" / "paper-groups"
TOLD = ("sheath_length_mm", "total_bend_rad", "preload_N")
ROUNDING = 1e-3  # of a standard error


def shipped(every):
    """Return the shipped recordings with one sample in so many."""
    data = tsas.read(SHIPPED)
    runs = {r.run.id: {n: v[::every] for n, v in r.columns.items()} for r in data}
    conditions = {r.run.id: {name: getattr(r.run, name) for name in TOLD} for r in data}
    sheet = data.manifest.rig.model_dump(exclude_none=True)
    return Raw(runs, conditions, sheet)


def test_shipped_recordings_in_other_units_are_calibrated_alike(tmp_path):
    raw = shipped(20)
    ours = Answers(raw, tmp_path / "mm").calibrate
    theirs = Answers(in_units(later(raw, 1e5), IMPERIAL), tmp_path / "inch").calibrate
    assert largest(apart(ours, theirs)) < ROUNDING


def test_a_drive_in_other_units_and_later_is_identified_alike(tmp_path):
    data = drive_dataset(tmp_path / "drive", LAGGING, duration_s=4.0, only=("chirp",))
    (columns,) = (recording.columns for recording in data)
    sheet = data.manifest.rig.model_dump(exclude_none=True)
    found = {}
    for name, start_s, per_rpm, unit in (("a", 0.0, 1.0, "rpm"), ("b", 1e4, np.pi / 30.0, "rad/s")):
        changed = {
            CLOCK: start_s + columns[CLOCK],
            "motor_speed_rpm": columns["motor_speed_rpm"] * per_rpm,
            "x_in_mm": columns["x_in_mm"],
        }
        units = {CLOCK: "s", "motor_speed_rpm": unit, "x_in_mm": "mm"}
        raw = Raw({"chirp": changed}, {"chirp": {}}, sheet, units)
        sources, path = raw.write(tmp_path / name)
        tsas.ingest(sources, map=path, out=tmp_path / name / "dataset")
        found[name] = tsas.identify_harmonic_drive(tmp_path / name / "dataset").summary
    assert found["a"]["structure"] == found["b"]["structure"]
    assert found["a"]["diagnosis"]["verdict"] == found["b"]["diagnosis"]["verdict"] == "named"
    for ours, theirs in zip(found["a"]["parameters"], found["b"]["parameters"], strict=True):
        assert theirs["value"] == pytest.approx(ours["value"], rel=1e-6), ours["name"]
