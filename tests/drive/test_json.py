"""What is written of a drive: kinematics, poles, response, structures, runs and its diagnosis."""

import math

import numpy as np
import pytest

from tests.drive.verdicts import TOLD, cause, verdict
from tsas_cli.drive import json as dj
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.harmonic_drive import DriveValues
from tsas_cli.drive.json import tables
from tsas_cli.drive.runs import FrequencyResponse
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.base import parameters_of
from tsas_cli.records.drive import DriveFile, DriveRunErrors, Kinematics, TriedStructure

SHEET = DataSheet(27.1, 120.0, 0.13, 2.3)


def test_the_lead_is_held_against_kinematics():
    """60 · 120/(2π · 27.1) rpm for each mm/s; fitted a quarter above it."""
    lead = 60.0 * 120.0 / (2.0 * math.pi * 27.1)
    fitted = {"kV_rpm_s_per_mm": Estimate("kV_rpm_s_per_mm", 1.25 * lead, "", "fitted")}
    found = dj.kinematics(SHEET, fitted)
    assert found.kinematic_lead_rpm_s_per_mm == pytest.approx(lead)
    assert found.kinematic_gain_mm_per_s_rpm == pytest.approx(1.0 / lead)
    assert found.fitted_above_kinematic_percent == pytest.approx(25.0)
    assert found.fitted_lead_rpm_s_per_mm == pytest.approx(1.25 * lead)
    none = dj.kinematics(DataSheet(None, None, None, None), fitted)
    assert none.kinematic_lead_rpm_s_per_mm is none.fitted_above_kinematic_percent is None


def seen(frequency, response=None, excited=None):
    frequency = np.asarray(frequency, dtype=float)
    response = np.ones(frequency.size, complex) if response is None else response
    excited = np.ones(frequency.size, bool) if excited is None else np.asarray(excited)
    return FrequencyResponse(frequency, response, np.ones(frequency.size), excited)


def test_poles_of_a_lag_a_delay_and_a_spring():
    """1/(2π τ), 1/(2π T), and the natural frequency; the integrator is none."""
    values = DriveValues(0.02, motor_lag_s=0.1, delay_s=0.05)
    lag, delay = dj.pole_rows(values, seen([0.5, 3.0]))
    assert (lag.kind, lag.real_per_s, lag.imaginary_per_s) == ("pole", pytest.approx(-10.0), 0.0)
    assert lag.frequency_Hz == pytest.approx(10.0 / (2.0 * math.pi))
    assert (delay.kind, delay.real_per_s) == ("1/delay", -20.0)
    assert delay.frequency_Hz == pytest.approx(20.0 / (2.0 * math.pi))
    springy = DriveValues(0.02, natural_frequency_Hz=4.0, damping_ratio=0.6)
    (one,) = dj.pole_rows(springy, seen([0.5, 9.0]))
    assert one.frequency_Hz == pytest.approx(4.0)
    assert one.real_per_s == pytest.approx(-0.6 * 8.0 * math.pi)
    assert one.imaginary_per_s == pytest.approx(0.8 * 8.0 * math.pi)
    assert dj.pole_rows(DriveValues(0.02), seen([0.5, 9.0])) == []


@pytest.mark.parametrize(
    ("band", "inside"),
    [((1.0, 1.92), True), ((1.0, 1.89), False), ((2.08, 9.0), True), ((2.11, 9.0), False)],
)
def test_a_pole_is_in_the_band_or_a_twentieth_beside_it(band, inside):
    """At 2 Hz."""
    values = DriveValues(0.02, motor_lag_s=1.0 / (4.0 * math.pi))
    for excited in (True, False):
        (row,) = dj.pole_rows(values, seen(band, excited=[excited] * 2))
        assert row.in_band == (inside and excited)


@pytest.mark.parametrize("turn", [0, 1, -2])
def test_measured_phases_are_on_the_turn_of_the_fitted_ones(monkeypatch, turn):
    """An integrator has −90°; what is not excited tells no turn."""
    frequency = np.linspace(1.0, 5.0, 5)
    response = 0.02 / (2j * math.pi * frequency)
    fitted = -90.0 + 360.0 * turn
    monkeypatch.setattr(dj, "bode_curve", lambda values, at: (0.0 * at, np.full(at.size, fitted)))
    values = DriveValues(0.02)
    found = dj.response(seen(frequency, response, [False, False, True, True, False]), values)
    assert found.band_Hz == (3.0, 4.0)
    np.testing.assert_allclose(found.measured.phase_deg, fitted)
    np.testing.assert_allclose(found.measured.magnitude, np.abs(response))
    curve = found.fitted.frequency_Hz
    assert (curve[0], curve[-1], len(curve)) == (pytest.approx(1.0), pytest.approx(5.0), 200)
    np.testing.assert_allclose(np.diff(np.log(curve)), math.log(5.0) / 199)
    dark = dj.response(seen(frequency, response, [False] * 5), values)
    assert dark.band_Hz is None
    np.testing.assert_allclose(dark.measured.phase_deg, -90.0)


def test_a_drive_as_tables():
    found = verdict("ambiguous", cause("backlash", rivals=("channel_delay",)), stated=True)
    tried = TriedStructure(name="lag", parameters=2, held_out_times_noise=1.2345)
    lead = Kinematics(kinematic_lead_rpm_s_per_mm=42.2841, fitted_lead_rpm_s_per_mm=40.0)
    copies = ({"chosen": True}, {}, {"converged": False})
    drive = DriveFile.model_construct(
        parameters=parameters_of([TOLD["play_mm"]]),
        kinematics=lead,
        diagnosis=found,
        structures=tuple(tried.model_copy(update=changed) for changed in copies),
        runs={"a": DriveRunErrors(rmse=0.12344, rmse_nominal=0.5, noise=0.0123)},
    )
    structures, parameters, runs, causes, error = (rows for *_, rows in tables(drive, "title"))
    assert [row[3] for row in structures] == ["chosen", "", "not converged"]
    assert structures[0][:3] == ("lag", "2", "1.23")
    assert parameters[0] == ("play_mm", "0.5 [0.3, 0.7]", "mm")
    assert parameters[1][1] == "42.284"
    assert list(runs) == [("a", "0.1234", "0.5", "0.012")]
    assert causes == [("backlash", "play_mm", "0.5 [0.3, 0.7]", "mm", "40.0", "channel_delay")]
    assert error == [["x_in_mm", "0.4", "0.2", "0.1", "mm", "0.15"]]
    less = {"kinematics": Kinematics(fitted_lead_rpm_s_per_mm=40.0), "diagnosis": verdict("named")}
    fewer = [rows for *_, rows in tables(drive.model_copy(update=less), "title")]
    assert [len(rows) for rows in fewer] == [3, 1, 1, 1]
