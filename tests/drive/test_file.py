import dataclasses

import pytest

from tests.refusals import refusal
from tsas_cli.drive.file import UNITS, IdentifiedDrive, checked_drive, read_drive, write_drive
from tsas_cli.identification.estimate import Estimate


def written(path, **values):
    estimates = {n: Estimate(n, v, UNITS[n], "fitted", None, 0.1) for n, v in values.items()}
    write_drive(path, estimates, {"name": "integrator"}, version="0", dataset={"name": "d"})
    return path


def test_what_is_written_is_read(tmp_path):
    values = {"gain_mm_per_s_rpm": 0.02, "motor_lag_s": 0.002, "natural_frequency_Hz": 88.0}
    path = written(tmp_path / "drive.toml", **values)
    drive = read_drive(path)
    assert drive == read_drive(tmp_path)
    assert (drive.gain_mm_per_s_rpm, drive.motor_lag_s) == (0.02, 0.002)
    assert drive.kV_rpm_s_per_mm == pytest.approx(50.0)
    assert drive.inertia_N_mm_s2 is None


def test_every_number_of_a_drive_has_a_unit():
    assert set(IdentifiedDrive.__dataclass_fields__) <= set(UNITS)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('unit = "mm/(s rpm)"', 'unit = "mm/s"', "expected the unit 'mm/(s rpm)'"),
        ("[parameters.gain_mm_per_s_rpm]", "[parameters.gain_mm]", "did you mean"),
        ("value = 0.02", "value = -0.02", "expected 1e-09 to 1e+06 mm/(s rpm)"),
        ("value = 0.02", "value = nan", "a finite number"),
        ('kind = "drive"', 'kind = "model"', "kind"),
        ("format = 1", "format = 2", "format"),
        ("[parameters.gain_mm_per_s_rpm]", "[parameters.kV_rpm_s_per_mm]", "unit"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, old, new, said):
    path = written(tmp_path / "drive.toml", gain_mm_per_s_rpm=0.02)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    line = refusal(read_drive, path)
    assert "drive.toml" in line
    assert said in line


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("gain_mm_per_s_rpm", 0.0, "expected 1e-09 to 1e+06 mm/(s rpm)"),
        ("kV_rpm_s_per_mm", float("nan"), "should be a finite number"),
        ("gear_ratio", 0.0, "expected 0.001 to 1e+06"),
        ("delay_s", -1.0, "expected 0, or 1e-09 to 1000 s"),
        ("motor_lag_s", "slow", "should be a number"),
    ],
)
def test_a_drive_in_memory_is_checked_like_its_file(name, value, said):
    drive = IdentifiedDrive(0.02, 50.0, gear_ratio=100.0)
    assert checked_drive(drive) is drive
    line = refusal(checked_drive, dataclasses.replace(drive, **{name: value}))
    assert name in line
    assert said in line
