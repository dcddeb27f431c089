"""What a controller knows of the drive, and what that does to its feedforward."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.drive.file import IdentifiedDrive
from tsas_cli.tracking.recorded import stated_rig
from tsas_cli.tracking.references import reference
from tsas_cli.tracking.settings import ReferenceSettings, Settings, actuator_of, known_drive
from tsas_cli.tracking.track import Known, Plant, feedforward, plan, run_loop

SETTINGS = Settings(reference=ReferenceSettings(duration_s=8.0))
FOUND = IdentifiedDrive(
    gain_mm_per_s_rpm=0.0226,
    kV_rpm_s_per_mm=44.2,
    kA_rpm_s2_per_mm=0.0884,
    motor_lag_s=0.002,
    delay_s=0.001,
    drive_stiffness_N_per_mm=52.0,
    inertia_N_mm_s2=0.1296,
    damping_N_s_per_mm=0.007,
    turntable_radius_mm=27.1,
    gear_ratio=120.0,
)


def test_without_a_file_it_is_stiff_kinematics():
    known = known_drive(None, SETTINGS.drive)
    assert 1.0 / known.gain_mm_per_s_rpm == pytest.approx(42.2847, rel=1e-5)
    assert (known.stiffness_N_per_mm, known.motor_lag_s) == (math.inf, 0.0)


def test_a_known_stiffness_goes_with_the_kinematics_and_not_with_the_fitted_gain():
    known = actuator_of(FOUND, 3000.0)
    assert 1.0 / known.gain_mm_per_s_rpm == pytest.approx(42.2847, rel=1e-5)
    assert known.stiffness_N_per_mm == 52.0
    assert known.motor_lag_s == pytest.approx(0.003)
    assert known.inertia_N_s2_per_mm == pytest.approx(0.1296 / 27.1**2)


@pytest.mark.parametrize("missing", ["drive_stiffness_N_per_mm", "gear_ratio"])
def test_without_it_the_fitted_inverse_feeds_forward(missing):
    known = actuator_of(replace(FOUND, **{missing: None}), 3000.0)
    assert known.stiffness_N_per_mm == math.inf
    assert 1.0 / known.gain_mm_per_s_rpm == pytest.approx(44.2)
    assert known.motor_lag_s / known.gain_mm_per_s_rpm == pytest.approx(0.0884)


def test_the_motor_leads_by_how_far_the_gear_winds_up_and_that_is_worth_it():
    rig = stated_rig(SETTINGS)
    wanted = reference("sine", SETTINGS.reference, SETTINGS.step_s)
    plant = Plant(rig, SETTINGS.drive.actuator())
    errors, ways = [], []
    for actuator in (known_drive(None, SETTINGS.drive), actuator_of(FOUND, 3000.0)):
        known = Known(rig, actuator)
        path = plan(wanted, known, SETTINGS)
        speed = feedforward(path, actuator)
        ways.append(float(np.sum(speed[300:3050]) * SETTINGS.step_s * actuator.gain_mm_per_s_rpm))
        errors.append(run_loop(wanted, path, known, plant, "pid", SETTINGS, seed=1).score.rmse_N)
    # In full slip, where the drive feels e^(0.125 π) times the force at the load.
    wound_up = (wanted[3050] - wanted[300]) * math.exp(0.125 * math.pi) / 52.0
    assert ways[1] - ways[0] == pytest.approx(wound_up, rel=0.01)
    assert errors[1] < 0.05 * errors[0]
