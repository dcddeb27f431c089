"""What acts along the tendon, against solutions in closed form."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.effects.runs import UP_AND_DOWN, A, run
from tests.physics.references import (
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    course_of,
    slip_chain,
)
from tsas_cli.effects.stribeck_friction import StribeckFriction, stribeck, stribeck_factor
from tsas_cli.physics.response import NODES
from tsas_cli.physics.rig import with_values


def in_slip(response, direction, after=0.2):
    """Return the samples of full slip, without the last and first ones of a stroke."""
    slip = response.phase == direction
    moving = np.sign(np.gradient(response.x_in_mm)) == direction
    turn = np.abs(response.x_in_mm - 14.0) > after
    found = slip & moving & turn
    assert found.sum() > 300
    return found


DRIFTS = {
    "bend_drift": ({"rate_rad_per_s": 0.05}, lambda settled: 0.125 * (math.pi + 0.05 * settled)),
    "friction_drift": ({"rate_per_s": 0.02}, lambda settled: A * (1.0 + 0.02 * settled)),
}


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("name", DRIFTS)
def test_the_wrap_follows_the_time_and_settles(name, direction):
    settling = 0.2
    rates, wrap = DRIFTS[name]
    values = {f"{name}.{key}": value for key, value in rates.items()}
    answer = run(values | {f"{name}.settling_per_s": settling})
    slip = in_slip(answer, direction)
    time_s = np.arange(UP_AND_DOWN.size)[slip] * 0.02
    settled = (1.0 - np.exp(-settling * time_s)) / settling
    ratio = np.log(answer.f_in_N[slip] / answer.f_out_N[slip])
    np.testing.assert_allclose(ratio, direction * wrap(settled), rtol=1e-8)


@pytest.mark.parametrize("direction", [1, -1])
def test_pulleys_add_their_losses_in_full_slip(direction):
    answer = run({"pulley_friction.drive_loss": 0.05, "pulley_friction.load_loss": 0.08})
    slip = in_slip(answer, direction)
    ratio = np.log(answer.f_in_N[slip] / answer.f_out_N[slip])
    np.testing.assert_allclose(ratio, direction * (A + 0.13), rtol=1e-8)


def test_a_pulley_steps_at_its_own_end_of_the_dead_band():
    at_drive = run({"pulley_friction.drive_loss": 0.1})
    at_load = run({"pulley_friction.load_loss": 0.1})
    neither = run({})
    turn = int(np.argmax(UP_AND_DOWN))
    soon = turn + 3
    before = np.array([r.f_in_N[turn] for r in (at_drive, at_load, neither)])
    fell = np.log(before / [r.f_in_N[soon] for r in (at_drive, at_load, neither)])
    assert fell[0] > 0.2  # twice the loss, at once
    assert fell[1] == pytest.approx(fell[2], rel=0.1)
    # Until slip reaches the load, its tension is that of the reversal.
    rests = [np.sum(r.f_out_N[turn:] > r.f_out_N[turn] - 1e-6) for r in (at_load, neither)]
    assert rests[0] > 1.3 * rests[1]


def test_friction_is_nothing_where_its_law_would_be_negative():
    answer = run({"position_dependent_friction.slope_per_mm": -0.1})
    far = (answer.x_in_mm > 10.5) & (answer.x_in_mm < 13.0)
    np.testing.assert_allclose(answer.f_in_N[far], answer.f_out_N[far], rtol=1e-8)


@pytest.mark.parametrize("speed", [0.5, 2.0, 8.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_slow_sliding_has_more_friction(direction, speed):
    """Every point slides, once friction has settled, at a speed between those of both ends."""
    stribeck = {"excess": 0.3, "velocity_mm_per_s": 3.0}
    values = {f"stribeck_friction.{name}": value for name, value in stribeck.items()}
    answer = run(values, speed=speed)
    slip = np.flatnonzero(in_slip(answer, direction))
    slip = slip[slip.size // 2 :]
    of_load = speed * np.gradient(answer.x_out_mm)[slip] / np.gradient(answer.x_in_mm)[slip]
    least, most = (A * (1.0 + 0.3 * np.exp(-((v / 3.0) ** 2))) for v in (speed, of_load))
    wrap = direction * np.log(answer.f_in_N[slip] / answer.f_out_N[slip])
    assert np.all(least + 0.2 * (most - least) < wrap)
    assert np.all(wrap < most - 0.2 * (most - least))


@pytest.mark.parametrize("exponent", [1.0, 1.4, 2.0, 4.0])
def test_the_slope_of_friction_over_speed_is_that_of_its_factor(exponent):
    law = StribeckFriction(0.3, 5.0, exponent)
    assert stribeck(5.0, law)[0] == pytest.approx(1.0 + 0.3 * np.exp(-1.0), rel=1e-12)
    for speed in (-7.0, -0.02, 0.02, 5.0, 12.0):
        ahead, behind = (stribeck_factor(speed + h, law) for h in (1e-5, -1e-5))
        assert stribeck(speed, law)[1] == pytest.approx((ahead - behind) / 2e-5, rel=1e-4, abs=1e-9)
    assert stribeck(0.0, law) == (1.3, 0.0)


def test_friction_follows_a_change_of_speed_late():
    """On a stiff tendon every point has the drive's speed: dv/dt = (speed - v)/lag, first order."""
    law = {"excess": 0.3, "velocity_mm_per_s": 3.0, "lag_s": 0.02}
    values = {f"stribeck_friction.{name}": value for name, value in law.items()}
    stiff = GROUP_A._replace(tendon_stiffness_N=1e8)
    errors = []
    for h in (1e-3, 5e-4, 2.5e-4):
        time_s = np.arange(0.0, 1.1, h)
        x_in = 8.0 * np.minimum(time_s, 1.0) + 2.0 * np.maximum(time_s - 1.0, 0.0)
        answer = run(values, x_in, rig=stiff, time_s=time_s)
        after = time_s > 1.0 + 2e-3
        v = 2.0 + 6.0 * np.exp(-(time_s[after] - 1.0) / 0.02)
        wrap = A * (1.0 + 0.3 * np.exp(-((v / 3.0) ** 2)))
        found = np.log(answer.f_in_N[after] / answer.f_out_N[after])
        errors.append(np.max(np.abs(found - wrap)) / A)
    assert errors[-1] < 0.02
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(2.0, abs=0.4)


LENGTH = 0.05


def held_at_the_load(drive, load, rig, n):
    """Follow both ends; return how friction changes the tension from end to end."""
    course = course_of(drive, rig, load=load)
    return slip_chain(course, rig, LOADED_BY_DISPLACEMENT, n)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_tendon_at_rest_is_a_rod_on_bristles(sign):
    """EA x'' = k x with k = aF0/(L·length): stiffness EA q coth(qL), q² = k/EA, and no loop."""
    EA, L = GROUP_A.tendon_stiffness_N, GROUP_A.sheath_length_mm
    rig = with_values(GROUP_A, {"presliding.length_mm": LENGTH})
    x = sign * 1e-3 * LENGTH * np.sin(np.linspace(0.0, 4.0 * np.pi, 401))
    f_in = held_at_the_load(x, 0.0, rig, NODES)[2]
    q = math.sqrt(A * 25.0 / (L * LENGTH) / EA)
    stiffness = EA * q / math.tanh(q * L)
    np.testing.assert_allclose(f_in - 25.0, stiffness * x, atol=2e-3 * stiffness * np.abs(x).max())


DRAG = 3.0
DRAGGED = {"sheath_drag.force_N": DRAG}


@pytest.mark.parametrize("direction", [1, -1])
def test_drag_is_lost_beside_the_friction_of_the_capstan(direction):
    """dT/ds = −λ (μκT + D/L) from the drive to the load."""
    answer = run(DRAGGED)
    slip = in_slip(answer, direction)

    def slope(_, tension):
        return -direction * (A * tension + DRAG)

    along = solve_ivp(slope, (0.0, 1.0), answer.f_in_N[slip], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(answer.f_out_N[slip], along.y[:, -1], atol=1e-4)
