"""A damper and a mass at the drive, against the motion that they make possible."""

import math

import numpy as np
import pytest

from tests.effects.runs import run
from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.ends import SLIPS_ALONG_S

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


@pytest.mark.parametrize("dynamics", ["slip", "lugre"])
def test_a_damped_drive_gives_way_to_a_force_by_an_exponential(dynamics):
    """c dx/dt + K x = r t without friction: x = r/K (t − c/K (1 − e^(−K t/c)))."""
    t, rate, damping = np.arange(0.0, 1.0, 1e-3), 20.0, 0.4
    drive = DriveInput(25.0 + rate * t, kind="force", time_s=t)
    x = simulate(with_values(SMOOTH, {DAMPER: damping}), drive, dynamics, nodes=4).x_in_mm
    late = damping / STIFFNESS
    exact = rate / STIFFNESS * (t - late * (1.0 - np.exp(-t / late)))
    assert late > 0.2
    np.testing.assert_allclose(x, exact, atol=1e-3 * exact[-1])
    assert exact[-1] < 0.8 * simulate(SMOOTH, drive, dynamics, nodes=4).x_in_mm[-1]
    assert math.isclose(x[-1], exact[-1], rel_tol=1e-3)


MASS = "drive_inertia.mass_kg"


@pytest.mark.parametrize(("dynamics", "late_s"), [("slip", SLIPS_ALONG_S), ("lugre", 0.0)])
def test_a_mass_at_a_drive_by_force_is_a_second_order_low_pass(dynamics, late_s):
    """m x″ + c x′ + K x = A sin ωt without friction, once it has settled."""
    t, omega, mass, damping = np.arange(0.0, 2.0, 5e-4), 12.0, 5.0, 0.05
    wave = 20.0 * np.sin(omega * t)
    drive = DriveInput(40.0 + wave, kind="force", time_s=t)
    x = simulate(
        with_values(SMOOTH, {MASS: mass, DAMPER: damping}), drive, dynamics, nodes=4
    ).x_in_mm
    inertia = 1e-3 * mass * omega**2 / (1.0 + 1j * omega * late_s)
    response = 20.0 / (STIFFNESS - inertia + 1j * damping * omega)
    exact = 15.0 / STIFFNESS + np.imag(response * np.exp(1j * omega * t))
    settled = t > 1.2
    assert abs(response) > 1.3 * 20.0 / STIFFNESS  # near resonance
    assert np.abs(x - exact)[settled].max() < 0.01 * abs(response)
