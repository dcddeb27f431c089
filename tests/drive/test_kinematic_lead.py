"""A fitted lead that contradicts the data sheet is told, with what explains its factor."""

import math

import pytest

from tests.drive.verdicts import manifest
from tests.refusals import refusal
from tsas_cli.drive.estimates import DataSheet, drive_sheet
from tsas_cli.drive.sentences import lead_notes
from tsas_cli.identification.estimate import Estimate

SHEET = DataSheet(27.1, 120.0, 0.1296, 2.3384)
KINEMATIC = 1.0 / SHEET.kinematic_gain


def lead(factor, width=1e-4):
    value = factor * KINEMATIC
    ends = value * (1.0 - width), value * (1.0 + width)
    return Estimate("kV_rpm_s_per_mm", value, "rpm s/mm", "fitted", None, width * value, *ends)


def pull_back(value):
    return Estimate("pull_back_N_per_mm", value, "N/mm", "fitted")


@pytest.mark.parametrize(
    ("factor", "why"),
    [
        (1000.0, "x_in_mm looks like metre"),
        (25.4, "x_in_mm looks like inch"),
        (10.0, "x_in_mm looks like centimetre"),
        (1e-3, "x_in_mm looks like micrometre"),
        (2.0 * math.pi / 60.0, "motor_speed_rpm looks like rad/s"),
        (6.0, "motor_speed_rpm looks like degrees per second"),
        (1.0 / 60.0, "motor_speed_rpm looks like revolutions per second"),
        (1.0 / 120.0, "motor_speed_rpm looks like the speed behind the gear"),
        (2.0, "turntable_radius_mm looks like the diameter"),
        (0.5, "turntable_radius_mm like half the radius"),
        (3.0, "check gear_ratio (360 would agree), turntable_radius_mm (9.033 would agree)"),
        (1.2, "yields to the pull of the load (a stiffness of 11.7 N/mm)"),
    ],
)
def test_a_wrong_unit_or_number_is_told_by_its_factor(factor, why):
    (said,) = lead_notes(lead(factor), SHEET)
    assert why in said
    assert f"is {factor:.4g} times the kinematic one of the data sheet, 42.28 rpm s/mm" in said
    (wound_up,) = lead_notes(lead(1.045 * factor), SHEET)  # the paper's drive yields so much
    assert ("would agree" in why or "yields" in why) == (why not in wound_up)


def test_a_gear_ratio_of_one_is_no_gear():
    sheet = DataSheet(27.1, 1.0, None, None)
    (said,) = lead_notes(lead(1.0), sheet)
    assert said.endswith("0.3524 rpm s/mm: a gear_ratio of 120 would agree in place of 1.")


def test_what_agrees_is_silent():
    """Gear and radius may be off by a twentieth."""
    for factor, notes in ((1.0, 0), (1.049, 0), (0.951, 0), (1.051, 1), (0.949, 1)):
        assert len(lead_notes(lead(factor), SHEET)) == notes
    assert lead_notes(lead(1.3, width=0.4), SHEET) == []  # the interval holds it
    assert lead_notes(lead(1000.0), DataSheet(27.1, None, None, None)) == []


def test_a_drive_that_yields_as_the_data_sheet_says_explains_its_lead():
    assert lead_notes(lead(1.2), SHEET, pull_back(2.3)) == []
    (said,) = lead_notes(lead(1.2), SHEET, pull_back(9.0))
    assert said.endswith("; the drive's stiffness follows from it.")
    assert len(lead_notes(lead(1.2), DataSheet(27.1, 120.0, 0.13, None), pull_back(2.3))) == 1


SOUND = {"turntable_radius_mm": 27.1, "inertia_N_mm_s2": 0.13}


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"friction_coefficient": 1000.0}, "transmits no tension"),
        *(
            (
                {"inertia_N_mm_s2": inertia, "turntable_radius_mm": radius},
                "0.001 to 1e+06 Hz; check",
            )
            for inertia, radius in ((1e-9, 1e6), (1e9, 1e-4))
        ),
    ],
)
def test_a_data_sheet_of_no_drive_is_refused(wrong, said):
    """Before, an overflow, a division by zero, and residuals of nan × the noise level."""
    sound = drive_sheet(manifest((3.14,), **SOUND))
    assert sound.stated_frequency == pytest.approx(18.26, rel=1e-2)
    line = refusal(drive_sheet, manifest((3.14,), **SOUND | wrong))
    assert said in line
    assert "dataset.toml, rig" in line
