"""What acts along the tendon, against the sheath's equation solved in closed form.

In full slip the tension follows dF/ds = −λ(a F f(F) + C) over the unit length of the sheath.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, A, run
from tests.physics.references import GROUP_A, LOADED_BY_DISPLACEMENT, Profile, course_of
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import NODES, simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.chain import slip_chain


def in_slip(response, direction, after=0.2):
    """Return the samples of full slip, without the last and first ones of a stroke."""
    slip = response.phase == direction
    moving = np.sign(np.gradient(response.x_in_mm)) == direction
    turn = np.abs(response.x_in_mm - 14.0) > after
    found = slip & moving & turn
    assert found.sum() > 300
    return found


@pytest.mark.parametrize("direction", [1, -1])
def test_each_direction_has_its_own_capstan_ratio(direction):
    answer = run({"direction_dependent_friction.asymmetry": 0.2})
    slip = in_slip(answer, direction)
    wrap = A * (1.2 if direction == 1 else 0.8)
    np.testing.assert_allclose(
        np.log(answer.f_in_N[slip] / answer.f_out_N[slip]), direction * wrap, rtol=1e-8
    )


DRIFTS = {
    "bend_drift": ({"rate_rad_per_s": 0.05}, lambda settled: 0.125 * (math.pi + 0.05 * settled)),
    "friction_drift": ({"rate_per_s": 0.02}, lambda settled: A * (1.0 + 0.02 * settled)),
}


@pytest.mark.parametrize("settling", [0.0, 0.2])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("name", DRIFTS)
def test_the_wrap_follows_the_time(name, direction, settling):
    rates, wrap = DRIFTS[name]
    values = {f"{name}.{key}": value for key, value in rates.items()}
    answer = run(values | {f"{name}.settling_per_s": settling})
    slip = in_slip(answer, direction)
    time_s = np.arange(UP_AND_DOWN.size)[slip] * 0.02
    settled = (1.0 - np.exp(-settling * time_s)) / settling if settling else time_s
    ratio = np.log(answer.f_in_N[slip] / answer.f_out_N[slip])
    np.testing.assert_allclose(ratio, direction * wrap(settled), rtol=1e-8)


@pytest.mark.parametrize("slope", [0.03, -0.04])
@pytest.mark.parametrize("direction", [1, -1])
def test_friction_follows_the_place_of_the_drive(direction, slope):
    answer = run({"position_dependent_friction.slope_per_mm": slope})
    slip = in_slip(answer, direction)
    wrap = A * (1.0 + slope * answer.x_in_mm[slip])
    ratio = np.log(answer.f_in_N[slip] / answer.f_out_N[slip])
    np.testing.assert_allclose(ratio, direction * wrap, rtol=1e-8)


def test_friction_is_nothing_where_its_law_would_be_negative():
    answer = run({"position_dependent_friction.slope_per_mm": -0.1})
    far = (answer.x_in_mm > 10.5) & (answer.x_in_mm < 13.0)
    np.testing.assert_allclose(answer.f_in_N[far], answer.f_out_N[far], rtol=1e-8)


def test_wear_follows_the_session():
    answer = run({"friction_drift.session_rate_per_s": 1e-3}, session_s=200.0)
    slip = in_slip(answer, 1)
    np.testing.assert_allclose(
        np.log(answer.f_in_N[slip] / answer.f_out_N[slip]), 1.2 * A, rtol=1e-8
    )


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


def test_friction_follows_a_change_of_speed_ten_milliseconds_late():
    """On a stiff tendon every point has the drive's speed: dv/dt = (speed - v)/lag, first order."""
    values = {"stribeck_friction.excess": 0.3, "stribeck_friction.velocity_mm_per_s": 3.0}
    stiff = GROUP_A._replace(tendon_stiffness_N=1e8)
    errors = []
    for h in (1e-3, 5e-4, 2.5e-4):
        time_s = np.arange(0.0, 1.1, h)
        x_in = 8.0 * np.minimum(time_s, 1.0) + 2.0 * np.maximum(time_s - 1.0, 0.0)
        answer = run(values, x_in, rig=stiff, time_s=time_s)
        after = time_s > 1.0 + 2e-3
        v = 2.0 + 6.0 * np.exp(-(time_s[after] - 1.0) / 0.01)
        wrap = A * (1.0 + 0.3 * np.exp(-((v / 3.0) ** 2)))
        found = np.log(answer.f_in_N[after] / answer.f_out_N[after])
        errors.append(np.max(np.abs(found - wrap)) / A)
    assert errors[-1] < 0.02
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(2.0, abs=0.4)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_viscous_loss_comes_on_top_along_the_sheath(direction):
    """F + C/a falls by e^(−λa): exact but for half a node's friction on the loss."""
    speed, coefficient = 4.0, 0.5
    lost = speed * coefficient
    answer = run({"viscous_friction.coefficient_N_s_per_mm": coefficient}, speed=speed)
    slip = in_slip(answer, direction)
    f_out = (answer.f_in_N[slip] + lost / A) * math.exp(-direction * A) - lost / A
    np.testing.assert_allclose(answer.f_out_N[slip], f_out, atol=lost * A / NODES)


@pytest.mark.parametrize("exponent", [0.4, -0.4])
@pytest.mark.parametrize("direction", [1, -1])
def test_friction_that_depends_on_the_tension_bends_the_capstan(direction, exponent):
    """(F/F0)^−β grows by λβa over the sheath."""
    answer = run({"load_dependent_friction.exponent": exponent})
    slip = in_slip(answer, direction)
    powers = (answer.f_in_N[slip] / 25.0) ** -exponent + direction * exponent * A
    np.testing.assert_allclose(answer.f_out_N[slip], 25.0 * powers ** (-1.0 / exponent), rtol=1e-5)


@pytest.mark.parametrize("slope", [1.5, -1.5])
def test_uneven_friction_shapes_dead_bands_and_not_full_slip(slope):
    """The profile of tension, whose friction up to s is a (s + slope (s² − s)/2), bent by hand."""
    legs = ((25, 60, 60), (60, 46, 45), (46, 57, 30))
    way = np.concatenate([np.linspace(*leg) for leg in legs])
    profile, x_in, f_out = Profile(GROUP_A, 4001), [], []
    reached = profile.s + 0.5 * slope * (profile.s**2 - profile.s)
    for tension in way:
        profile._change(tension, profile.tension[0], reached)
        profile.x_out = (profile.tension[-1] - 25.0) / GROUP_A.load_stiffness_N_per_mm
        x_in.append(profile.x_in)
        f_out.append(profile.tension[-1])
    rig = with_values(GROUP_A, {"uneven_friction.slope": slope})
    uneven, even = (
        simulate(r, DriveInput(np.array(x_in)), on_mesh=True, nodes=200) for r in (rig, GROUP_A)
    )
    np.testing.assert_allclose(uneven.f_in_N, way, atol=0.12)  # at first, of the mesh
    np.testing.assert_allclose(uneven.f_out_N, f_out, atol=1e-3)
    assert np.abs(even.f_in_N - way).max() > 2.0
    slips = even.phase == 1
    assert slips.sum() > 30
    np.testing.assert_allclose(uneven.f_out_N[slips], even.f_out_N[slips], atol=0.06)


def test_a_compressed_sheath_is_a_softer_tendon():
    softer = GROUP_A._replace(tendon_stiffness_N=GROUP_A.tendon_stiffness_N / 1.4)
    pressed, soft = run({"sheath_compression.compliance_ratio": 0.4}), run({}, rig=softer)
    np.testing.assert_allclose(pressed.f_in_N, soft.f_in_N, rtol=1e-9)


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


def test_a_long_stroke_on_bristles_turns_round_as_dahl_says():
    """Both ends of a stiff tendon move alike: f (1 − 2 e^(−way/length)) after a reversal.

    A loop is then 4 f (stroke − length tanh(stroke/length)).
    """
    rig = GROUP_A._replace(friction_coefficient=1e-3)
    rig = with_values(rig, {"presliding.length_mm": LENGTH})
    x = 0.4 * np.interp(np.linspace(0, 9, 9001), np.arange(10), [0, 1, -1, 1, -1, 1, -1, 1, -1, 1])
    _, _, f_in, f_out, _ = held_at_the_load(x, x, rig, 30)
    loop = slice(1000, 3001)
    friction = 25.0 * math.pi * 1e-3
    work = np.trapezoid((f_in - f_out)[loop], x[loop])
    stroke = 0.4 - LENGTH * math.tanh(0.4 / LENGTH)
    assert work == pytest.approx(4.0 * friction * stroke, rel=0.002)
    down, up = slice(1000, 2001), slice(2000, 3001)
    for half, sign in ((down, -1.0), (up, 1.0)):
        turned = 1.0 - 2.0 * np.exp(-np.abs(x[half] - x[half][0]) / LENGTH)
        left = (f_in - f_out)[half] - sign * friction * turned
        np.testing.assert_allclose(left, 0.0, atol=0.005 * friction)
