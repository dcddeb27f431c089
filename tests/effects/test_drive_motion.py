"""A damper at the drive, against the motion that it makes possible."""

import math

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, run
from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

SMOOTH = GROUP_A._replace(friction_coefficient=1e-9)
STIFFNESS = 1.0 / (1.0 / 1.579 + SMOOTH.sheath_length_mm / SMOOTH.tendon_stiffness_N)
DAMPER = "drive_damping.coefficient_N_s_per_mm"


@pytest.mark.parametrize("speed", [1.0, 8.0])
def test_a_damper_at_the_drive_is_felt_by_its_sensor_alone(speed):
    damped, plain = run({DAMPER: 0.3}, speed=speed), run({}, speed=speed)
    added = damped.f_in_N - plain.f_in_N
    np.testing.assert_allclose(added[:700], 0.3 * speed, rtol=1e-9)
    np.testing.assert_allclose(added[701:], -0.3 * speed, rtol=1e-9)
    np.testing.assert_array_equal(damped.f_out_N, plain.f_out_N)
    np.testing.assert_array_equal(damped.x_out_mm, plain.x_out_mm)


def test_without_times_a_damper_does_nothing():
    rig, drive = with_values(GROUP_A, {DAMPER: 0.3}), DriveInput(UP_AND_DOWN)
    np.testing.assert_array_equal(simulate(rig, drive).f_in_N, simulate(GROUP_A, drive).f_in_N)


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
def test_a_damped_drive_gives_way_to_a_force_by_an_exponential(dynamics):
    """c dx/dt + K x = r t without friction: x = r/K (t − c/K (1 − e^(−K t/c)))."""
    t, rate, damping = np.arange(0.0, 1.0, 1e-3), 20.0, 0.4
    drive = DriveInput(25.0 + rate * t, kind="force", time_s=t)
    x = simulate(with_values(SMOOTH, {DAMPER: damping}), drive, dynamics).x_in_mm
    late = damping / STIFFNESS
    exact = rate / STIFFNESS * (t - late * (1.0 - np.exp(-t / late)))
    assert late > 0.2
    np.testing.assert_allclose(x, exact, atol=1e-3 * exact[-1])
    assert exact[-1] < 0.8 * simulate(SMOOTH, drive, dynamics).x_in_mm[-1]
    assert math.isclose(x[-1], exact[-1], rel_tol=1e-3)
