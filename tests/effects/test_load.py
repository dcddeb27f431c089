"""What acts at the load, against the balance of forces there."""

import math

import numpy as np
import pytest

from tests.effects.runs import A, run
from tests.physics.references import GROUP_A
from tsas_cli.physics.slip.ends import SLIPS_ALONG_S

KL = GROUP_A.load_stiffness_N_per_mm
MOVING_UP = slice(400, 700)
MOVING_DOWN = slice(1000, 1300)


def spring_of(answer):
    return 25.0 + KL * answer.x_out_mm


@pytest.mark.parametrize(("part", "sign"), [(MOVING_UP, 1.0), (MOVING_DOWN, -1.0)])
def test_friction_behind_the_sensor_is_felt_by_it(part, sign):
    answer = run({"load_friction.after_sensor_N": 2.0})
    np.testing.assert_allclose((answer.f_out_N - spring_of(answer))[part], sign * 2.0, rtol=1e-8)
    np.testing.assert_allclose(np.log(answer.f_in_N / answer.f_out_N)[part], sign * A, rtol=1e-8)


@pytest.mark.parametrize(("part", "sign"), [(MOVING_UP, 1.0), (MOVING_DOWN, -1.0)])
def test_friction_before_the_sensor_is_felt_by_the_drive_alone(part, sign):
    answer = run({"load_friction.before_sensor_N": 2.0})
    np.testing.assert_allclose(answer.f_out_N[part], spring_of(answer)[part], rtol=1e-9)
    behind_sheath = (answer.f_out_N[part] + sign * 2.0) * math.exp(sign * A)
    np.testing.assert_allclose(answer.f_in_N[part], behind_sheath, rtol=1e-9)


def test_a_load_that_sticks_lets_its_sensor_fall_by_twice_the_friction():
    answer = run({"load_friction.after_sensor_N": 2.0})
    standing = np.flatnonzero(answer.x_out_mm == answer.x_out_mm[700])
    assert standing.size > 10
    fallen = answer.f_out_N[700] - answer.f_out_N[standing]
    assert fallen.max() == pytest.approx(4.0, abs=0.5)
    assert fallen.max() <= 4.0 + 1e-9
    assert (np.diff(fallen) >= -1e-9).all()


@pytest.mark.parametrize("part", [MOVING_UP, MOVING_DOWN])
def test_a_spring_that_bends(part):
    values = {"quadratic_per_mm": 0.02, "cubic_per_mm2": -0.001}
    answer = run({f"load_spring_nonlinearity.{name}": value for name, value in values.items()})
    x = answer.x_out_mm
    force = 25.0 + KL * x * (1.0 + 0.02 * x - 0.001 * x * x)
    np.testing.assert_allclose(answer.f_out_N[part], force[part], rtol=1e-8)
    assert np.abs(force - spring_of(answer))[part].max() > 1.0


@pytest.mark.parametrize(
    ("settling", "lost"), [(0.0, 0.3 * 28.0), (0.2, 1.5 * (1 - math.exp(-5.6)))]
)
def test_an_anchor_that_gives_way(settling, lost):
    values = {"rate_N_per_s": 0.3, "settling_per_s": settling}
    answer = run({f"preload_loss.{name}": value for name, value in values.items()})
    missing = spring_of(answer) - answer.f_out_N
    assert missing[0] == pytest.approx(0.0, abs=1e-9)
    assert missing[-1] == pytest.approx(lost, rel=1e-9)


MASS, OMEGA = 3.0, 4.0


def of_a_mass(samples):
    """Return f_out and what it should be, for a load that is made to follow a known motion.

    The load moves with 1 − cos ωt, and its mass with the same after a lag of the first order.
    Without friction the drive's travel is that of the load and the stretch of the tendon.
    """
    t = np.linspace(0.0, 3.0, samples)
    x_out = t - np.sin(OMEGA * t) / OMEGA
    phase = math.atan(OMEGA * SLIPS_ALONG_S)
    lagging = 1.0 - math.cos(phase) * np.cos(OMEGA * t - phase)
    lagging -= math.sin(phase) ** 2 * np.exp(-t / SLIPS_ALONG_S)
    taken_up = (1.0 - np.cos(OMEGA * t) - lagging) / SLIPS_ALONG_S
    tension = 25.0 + KL * x_out + 1e-3 * MASS * taken_up
    smooth = GROUP_A._replace(friction_coefficient=1e-12)
    x_in = x_out + (tension - 25.0) * smooth.sheath_length_mm / smooth.tendon_stiffness_N
    return run({"load_inertia.mass_kg": MASS}, x_in, rig=smooth, time_s=t), tension, x_out, t


def test_a_mass_needs_a_force_to_speed_up():
    """Newton's law but for the lag, and of first order in the time between samples."""
    apart = []
    for samples in (3001, 6001):
        answer, tension, x_out, t = of_a_mass(samples)
        np.testing.assert_allclose(answer.x_out_mm, x_out, atol=1e-3)
        apart.append(np.abs(answer.f_out_N - tension).max())
    newton = 1e-3 * MASS * OMEGA * np.sin(OMEGA * t)
    most = np.abs(newton).max()
    assert np.abs(tension - 25.0 - KL * x_out - newton).max() < OMEGA * SLIPS_ALONG_S * most
    assert apart[0] < 0.05 * most
    assert apart[0] / apart[1] == pytest.approx(2.0, rel=0.2)
