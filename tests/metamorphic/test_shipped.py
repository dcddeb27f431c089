"""The same of shipped recordings, and of a drive: other units and another clock say the same."""

from pathlib import Path

import pytest

import tsas_cli as tsas
from tests.drives import LAGGING, drive_dataset
from tests.metamorphic.answers import Answers, apart
from tests.metamorphic.raw import CLOCK, IMPERIAL, Raw, in_units, later, resampled

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
    assert apart(ours, theirs) < ROUNDING


def identified(raw, folder):
    """Return what is said of a drive."""
    sources, path = raw.write(folder)
    tsas.ingest(sources, map=path, out=folder / "dataset")
    return tsas.identify_harmonic_drive(folder / "dataset").summary


def test_a_drive_in_other_units_later_and_on_a_faster_clock_is_identified_alike(tmp_path):
    data = drive_dataset(tmp_path / "drive", LAGGING, duration_s=4.0, only=("chirp",))
    (columns,) = (recording.columns for recording in data)
    units = {CLOCK: "s", "motor_speed_rpm": "rpm", "x_in_mm": "mm"}
    sheet = data.manifest.rig.model_dump(exclude_none=True)
    raw = Raw({"chirp": {n: columns[n] for n in units}}, {"chirp": {}}, sheet, units)
    other = {CLOCK: "ms", "motor_speed_rpm": "rad/s", "x_in_mm": "in"}
    ours = identified(raw, tmp_path / "ours")
    assert ours["diagnosis"]["verdict"] == "named"
    for name, changed, within in (
        ("units", in_units(later(raw, 1e4), other), 1e-6),
        ("clock", resampled(raw, 2), 1e-2),  # the lag is told by other weights
    ):
        theirs = identified(changed, tmp_path / name)
        assert theirs["structure"] == ours["structure"]
        assert theirs["diagnosis"]["verdict"] == "named"
        for a, b in zip(ours["parameters"], theirs["parameters"], strict=True):
            assert b["value"] == pytest.approx(a["value"], rel=within), a["name"]
