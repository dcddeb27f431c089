"""What acts along the tendon, in closed form; at each node: physics/slip/test_small_chains.py."""

import math

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


def test_friction_is_nothing_where_its_law_would_be_negative():
    answer = run({"position_dependent_friction.slope_per_mm": -0.1})
    far = (answer.x_in_mm > 10.5) & (answer.x_in_mm < 13.0)
    np.testing.assert_allclose(answer.f_in_N[far], answer.f_out_N[far], rtol=1e-8)


@pytest.mark.parametrize("exponent", [1.0, 1.4, 2.0, 4.0])
def test_the_slope_of_friction_over_speed_is_that_of_its_factor(exponent):
    law = StribeckFriction(0.3, 5.0, exponent)
    assert stribeck(5.0, law)[0] == pytest.approx(1.0 + 0.3 * np.exp(-1.0), rel=1e-12)
    for speed in (-7.0, -0.02, 0.02, 5.0, 12.0):
        ahead, behind = (stribeck_factor(speed + h, law) for h in (1e-5, -1e-5))
        assert stribeck(speed, law)[1] == pytest.approx((ahead - behind) / 2e-5, rel=1e-4, abs=1e-9)
    assert stribeck(0.0, law) == (1.3, 0.0)


LENGTH = 0.05


def held_at_the_load(drive, load, rig, n):
    """Follow both ends; return how friction changes the tension from end to end."""
    course = course_of(drive, rig, load=load)
    return slip_chain(course, rig, LOADED_BY_DISPLACEMENT, n)


@pytest.mark.parametrize("growth", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_tendon_at_rest_is_a_rod_on_bristles(sign, growth):
    """EA x'' = k x with k = aF0/(L·length): stiffness EA q coth(qL), q² = k/EA, and no loop.

    At the preload of 25 N the part of the length that grows is 2.5 times that at 10 N.
    """
    EA, L = GROUP_A.tendon_stiffness_N, GROUP_A.sheath_length_mm
    at_10_N = LENGTH / (1.0 + 1.5 * growth)
    rig = with_values(GROUP_A, {"presliding.length_mm": at_10_N, "presliding.growth": growth})
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
