"""The laws of the slip chain's nodes and ends one by one, each against what it says by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    moment,
)
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.physics.boundary import moving_friction, unloaded_position
from tsas_cli.physics.course import Losses
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.ends import (
    drive_position,
    load_force,
    load_tangent,
    update_end,
    update_end_speeds,
    update_ends,
)
from tsas_cli.physics.slip.nodes import (
    accept,
    breakaway,
    capstan_ratio,
    extrapolate,
    is_linear,
    set_capstan_relations,
    set_friction,
    slips_backwards,
    update_relations,
    update_travel,
)
from tsas_cli.physics.slip.start import chain_at_rest, slip_laws
from tsas_cli.physics.slip.state import (
    DROP,
    DROP_SLOPE,
    END_SPEED,
    FACTOR,
    POSITION,
    POSITION_BEFORE,
    RATIO_PULLED,
    RATIO_RELEASED,
    SHARE,
    SHARE_BEFORE,
    SLIP,
    SWEEP_P,
    SWEEP_Q,
    SWEEP_R,
    TENSION,
    TENSION_BEFORE,
    TENSION_RISE,
    TRAVEL,
    WRAP_PULLED,
    WRAP_RELEASED,
    WRAP_SIGNED,
    Moment,
)

N = 3
LAST = N + 1
NODES = slice(1, N + 1)
F0, KL = 25.0, 1.579
NOW = Moment(30.0, 27.0, Losses(0.6, 0.45, 1.2, 2.0), 0.05)
TENSIONS = np.array([40.0, 31.0, 22.0, 13.0])
EXPONENTS = [-1.0, -0.4, 0.3, 1.0]


def laws(**values):
    """Return the laws of a rig with these effects, named with two underscores for a dot."""
    rig = with_values(GROUP_A, {name.replace("__", "."): v for name, v in values.items()})
    return slip_laws(rig, N, LOADED_BY_SPRING)


@pytest.fixture
def chain():
    """A chain at rest whose tensions fall towards the load."""
    found = chain_at_rest(GROUP_A, N)
    found[TENSION : TENSION + N + 1] = TENSIONS
    return found


def row(chain, at):
    return chain[at : at + N + 2]


MEANS = 0.5 * (TENSIONS[1:] + TENSIONS[:-1])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("exponent", [0.0, *EXPONENTS])
def test_friction_follows_a_power_of_the_mean_tension_at_a_node(chain, exponent, sign):
    row(chain, TENSION)[:] *= sign
    set_friction(chain, NOW, laws(load_dependent_friction__exponent=exponent))
    factor = (MEANS / F0) ** exponent
    for by, passed, wrap in (
        (WRAP_PULLED, RATIO_PULLED, 0.6),
        (WRAP_RELEASED, RATIO_RELEASED, 0.45),
    ):
        np.testing.assert_allclose(row(chain, by)[NODES], wrap / N * factor, rtol=1e-9)
        np.testing.assert_allclose(row(chain, passed)[NODES], np.exp(-wrap / N * factor), rtol=1e-9)


def test_friction_stays_finite_where_no_tension_is_left(chain):
    """Its tension counts as a hundredth of the preload, and a node passes on e^−30 at least."""
    row(chain, TENSION)[:] = 1e-9
    set_friction(chain, NOW, laws(load_dependent_friction__exponent=-0.5))
    np.testing.assert_allclose(row(chain, WRAP_PULLED)[NODES], 0.2 * 10.0)
    set_friction(chain, NOW, laws(load_dependent_friction__exponent=-1.5))
    np.testing.assert_allclose(row(chain, WRAP_PULLED)[NODES], 30.0)
    np.testing.assert_allclose(row(chain, WRAP_RELEASED)[NODES], 30.0)


NOT_STRAIGHT = [
    "load_dependent_friction__exponent",
    "presliding__length_mm",
    "load_inertia__mass_kg",
    "load_spring_nonlinearity__quadratic_per_mm",
    "load_spring_nonlinearity__cubic_per_mm2",
]


def test_what_is_not_straight():
    assert is_linear(laws(drive_friction__friction_N=2.0, load_friction__before_sensor_N=1.0))
    for name in NOT_STRAIGHT:
        assert not is_linear(laws(**{name: 0.1})), name


@pytest.mark.parametrize(
    ("direction", "sign", "expected"),
    [(1.0, 1, -0.2), (-1.0, 1, 0.15), (1.0, -1, 0.2), (-1.0, -1, -0.15)],
)
def test_what_a_slipping_node_passes_on(chain, direction, sign, expected):
    """Towards the drive less tension is left; of a negative one friction takes its magnitude."""
    set_friction(chain, NOW, laws())
    row(chain, TENSION)[:] *= sign
    assert capstan_ratio(direction, 2, chain) == pytest.approx(math.exp(expected))
    row(chain, TENSION)[1:3] = sign * 10.0, -sign * 9.0  # the sum of both sides decides
    assert capstan_ratio(direction, 2, chain) == pytest.approx(math.exp(expected))


def test_sliding_nodes_lose_half_of_the_viscous_loss_on_either_side(chain):
    straight = laws()
    set_friction(chain, NOW, straight)
    row(chain, SLIP)[NODES] = 1.0, 0.0, -1.0
    row(chain, FACTOR)[2] = 7.0
    assert set_capstan_relations(chain, NOW, straight)
    assert not set_capstan_relations(chain, NOW, straight)
    assert row(chain, FACTOR)[2] == 7.0  # a node that sticks is left alone
    for i, slip, wrap in ((1, 1.0, 0.6), (3, -1.0, 0.45)):
        before, half = 33.0, 0.5 * slip * 1.2 / N
        behind = math.exp(-slip * wrap / N) * (before - half) - half
        passed = row(chain, FACTOR)[i] * before - row(chain, DROP)[i]
        assert passed == pytest.approx(behind)
        assert row(chain, FACTOR)[i] == pytest.approx(math.exp(-slip * wrap / N))
    assert not update_relations(chain, moment(NOW, pulled=0.7), straight)  # by `set_friction` alone
    set_friction(chain, moment(NOW, pulled=0.7), straight)
    assert update_relations(chain, moment(NOW, pulled=0.7), straight)


def behind_of(before, share, exponent):
    """Solve the law of one node for the tension behind it."""

    def off(behind):
        mean, half = 0.5 * (before + behind), 0.5 * share * 1.2 / N
        wrap = share * (0.6 if share > 0.0 else 0.45) / N * (abs(mean) / F0) ** exponent
        ratio = math.exp(-math.copysign(wrap, mean) if share > 0.0 else math.copysign(-wrap, mean))
        return behind + half - ratio * (before - half)

    return brentq(off, 0.5 * before, 1.6 * before, xtol=1e-13)


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_the_tangent_of_a_sliding_node_touches_its_law(chain, exponent, slip):
    """Where its tensions keep to the law, the tangent goes through them with the law's slope."""
    bent = laws(load_dependent_friction__exponent=exponent)
    before, expected = 25.0, []
    for i in range(1, N + 1):
        behind = behind_of(before, slip, exponent)
        nudged = [behind_of(before + d, slip, exponent) for d in (-1e-4, 1e-4)]
        expected.append(((nudged[1] - nudged[0]) / 2e-4, behind))
        row(chain, TENSION)[i - 1 : i + 1] = before, behind
        before = behind
    row(chain, SLIP)[NODES] = slip
    set_friction(chain, NOW, bent)
    assert not update_relations(chain, NOW, bent)
    for i, (slope, behind) in enumerate(expected, 1):
        passes, takes = row(chain, FACTOR)[i], row(chain, DROP)[i]
        assert passes == pytest.approx(slope, rel=1e-6)
        assert passes * row(chain, TENSION)[i - 1] - takes == pytest.approx(behind, rel=1e-9)
    row(chain, TENSION)[N] *= 1.0 + 1e-6
    set_friction(chain, NOW, bent)
    assert update_relations(chain, NOW, bent)  # one node that breaks its law is enough
    slope, behind = expected[-1]
    line = row(chain, FACTOR)[N] * row(chain, TENSION)[N - 1] - row(chain, DROP)[N]
    assert line == pytest.approx(behind, rel=1e-10)  # one step of Newton's method mends it
    row(chain, SLIP)[N] = 0.0
    assert not update_relations(chain, NOW, bent)  # of a node that sticks nothing is asked


def test_the_sign_of_the_tension_is_that_of_both_sides_of_a_node(chain):
    """Whatever the next segment carries: friction of a pull takes from the magnitude here."""
    bent = laws(load_dependent_friction__exponent=0.3)
    row(chain, TENSION)[: N + 1] = 40.0, -10.0, -30.0, 50.0
    row(chain, SLIP)[NODES] = 1.0
    set_friction(chain, NOW, bent)
    update_relations(chain, NOW, bent)
    wraps = 0.2 * (np.array([15.0, 20.0, 10.0]) / F0) ** 0.3
    np.testing.assert_allclose(row(chain, WRAP_SIGNED)[NODES], [-wraps[0], wraps[1], -wraps[2]])


@pytest.mark.parametrize("moved", [0.03, -0.03])
@pytest.mark.parametrize("exponent", [0.0, 0.3])
def test_the_tangent_of_a_bristle_is_the_slope_of_its_law_over_the_way(chain, moved, exponent):
    length, turned = 0.05, np.array([0.2, -0.4, 0.7])
    bristly = laws(presliding__length_mm=length, load_dependent_friction__exponent=exponent)
    row(chain, POSITION_BEFORE)[NODES] = 1.0, 0.8, 0.5
    row(chain, POSITION)[NODES] = row(chain, POSITION_BEFORE)[NODES] + moved
    row(chain, TRAVEL)[NODES] = 0.5 * moved
    row(chain, SHARE_BEFORE)[NODES] = turned

    def share(way, z):
        limit = math.copysign(1.0, way)
        return limit + (z - limit) * math.exp(-abs(way) / length)

    before, expected = 40.0, []
    for i in range(1, N + 1):

        def behind(way, i=i, before=before):
            return behind_of(before, share(way, turned[i - 1]), exponent)

        slope = (behind(moved + 1e-6) - behind(moved - 1e-6)) / 2e-6
        expected.append((slope, behind(moved)))
        row(chain, TENSION)[i - 1 : i + 1] = before, behind(moved)
        before = behind(moved)
    set_friction(chain, NOW, bristly)
    assert not update_relations(chain, NOW, bristly)
    for i, (slope, behind) in enumerate(expected, 1):
        assert row(chain, SHARE)[i] == pytest.approx(share(moved, turned[i - 1]))
        assert -row(chain, DROP_SLOPE)[i] == pytest.approx(slope, rel=1e-5)
        line = row(chain, FACTOR)[i] * row(chain, TENSION)[i - 1] - row(chain, DROP)[i]
        line -= row(chain, DROP_SLOPE)[i] * row(chain, POSITION)[i]
        assert line == pytest.approx(behind, rel=1e-9)


def test_a_way_that_would_turn_stops_at_its_turning(chain):
    bristly = laws(presliding__length_mm=0.05)
    row(chain, POSITION)[NODES] = 0.02, 0.02, -0.01
    row(chain, TRAVEL)[NODES] = 0.01, 0.0, -0.03
    row(chain, SHARE_BEFORE)[NODES] = 0.5, -0.5, 0.1
    assert not update_travel(chain, bristly)
    assert row(chain, TRAVEL)[NODES].tolist() == [0.02, 0.02, -0.01]
    kept = math.exp(-0.4), math.exp(-0.2)
    np.testing.assert_allclose(
        row(chain, SHARE)[NODES],
        [1.0 - 0.5 * kept[0], 1.0 - 1.5 * kept[0], -1.0 + 1.1 * kept[1]],
        rtol=1e-9,
    )
    row(chain, TRAVEL)[2] = -1e-3
    assert update_travel(chain, bristly)
    assert row(chain, TRAVEL)[NODES].tolist() == [0.02, 0.0, -0.01]
    assert row(chain, SHARE)[2] == pytest.approx(-0.5)


def test_rounding_turns_no_way_of_a_node_that_rests(chain):
    """Else its step would never settle: the sign of a way of 1e-18 mm changes for ever."""
    bristly = laws(presliding__length_mm=0.05)
    row(chain, POSITION)[NODES] = row(chain, POSITION_BEFORE)[NODES] + 1e-15
    row(chain, TRAVEL)[NODES] = -1e-15
    assert not update_travel(chain, bristly)
    assert not row(chain, TRAVEL)[NODES].any()


def test_what_is_kept_and_expected(chain):
    """Laws that are not straight are looked for from where the last step would lead again."""
    row(chain, POSITION)[:] = 3.0, 2.0, 1.5, 1.0, 0.5
    row(chain, POSITION_BEFORE)[:] = 1.0
    was = row(chain, TENSION_BEFORE).copy()
    row(chain, SHARE)[NODES] = 0.995, -0.995, 0.985
    row(chain, SLIP)[:] = 5.0
    straight, bristly = laws(), laws(presliding__length_mm=0.05)
    again = chain.copy()
    accept(again, straight)
    assert not row(again, TRAVEL).any()
    assert row(again, SLIP).tolist() == [5.0] * 5
    np.testing.assert_array_equal(row(again, POSITION_BEFORE), row(chain, POSITION))
    np.testing.assert_array_equal(row(again, TENSION_BEFORE), row(chain, TENSION))
    x, tensions = row(chain, POSITION).copy(), row(chain, TENSION).copy()
    accept(chain, bristly)
    assert row(chain, SLIP).tolist() == [5.0, 1.0, -1.0, 0.0, 5.0]
    assert row(chain, SHARE_BEFORE)[NODES].tolist() == [0.995, -0.995, 0.985]
    np.testing.assert_allclose(row(chain, TRAVEL), x - 1.0)
    np.testing.assert_allclose(row(chain, TENSION_RISE), tensions - was)
    extrapolate(chain, bristly)
    np.testing.assert_allclose(row(chain, POSITION), 2.0 * x - 1.0)
    np.testing.assert_allclose(row(chain, TENSION), 2.0 * tensions - was)


@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_a_node_that_goes_against_its_slip_is_held(chain, slip):
    row(chain, SLIP)[2] = slip
    row(chain, POSITION_BEFORE)[2] = 0.3
    for way, back in ((1e-3, False), (0.0, False), (-1e-3, True), (-0.5e-12, False)):
        row(chain, POSITION)[2] = 0.3 + slip * way
        assert slips_backwards(2, chain, at(laws(), scale=0.01)) == back
    row(chain, POSITION)[2] = 0.3 - slip * 2e-12
    assert slips_backwards(2, chain, at(laws(), scale=0.01))


def test_a_node_is_pulled_loose_outside_of_the_capstan_ratio(chain):
    """Within it, and half of the viscous loss on either side, it holds."""
    set_friction(chain, NOW, laws())
    before, half = 40.0, 0.2
    least = math.exp(-0.2) * (before - half) - half
    most = math.exp(0.15) * (before + half) + half
    for behind, expected in (
        (least + 1e-6, 0.0),
        (least - 1e-6, 1.0),
        (most - 1e-6, 0.0),
        (most + 1e-6, -1.0),
        (least - 1e-9, 0.0),  # within rounding
        (most + 1e-9, 0.0),
    ):
        row(chain, TENSION)[1:3] = before, behind
        assert breakaway(2, 2.0 * half, chain) == expected


SPRING = {
    "load_spring_nonlinearity__quadratic_per_mm": 0.1,
    "load_spring_nonlinearity__cubic_per_mm2": 0.05,
}


@pytest.mark.parametrize("mass", [0.0, 40.0])
@pytest.mark.parametrize("step_s", [0.05, math.inf])
def test_what_the_load_pulls_back_with_is_a_tangent(chain, mass, step_s):
    row(chain, POSITION_BEFORE)[LAST], row(chain, END_SPEED)[LAST] = 1.1, 3.0

    def pull(x):
        force = F0 - 2.0 + KL * x * (1.0 + 0.1 * x + 0.05 * x * x)
        if step_s == math.inf:
            return force
        speed = (x - 1.1) / step_s
        return force + mass * 1e-3 * (speed - 3.0) / (step_s + 0.01)

    heavy = laws(load_inertia__mass_kg=mass, **SPRING)
    row(chain, POSITION)[LAST] = x = 1.4
    now = moment(NOW, step_s=step_s)
    slope, value = load_tangent(chain, now, heavy)
    assert slope == pytest.approx((pull(x + 1e-5) - pull(x - 1e-5)) / 2e-5, rel=1e-7)
    assert value + slope * x == pytest.approx(pull(x))
    assert load_force(chain, now, at(heavy, LOADED_BY_SPRING)) == pytest.approx(pull(x))
    assert load_force(chain, now, at(heavy, LOADED_BY_FORCE)) == 27.0


def test_a_mass_takes_up_its_speed_in_a_hundredth_of_a_second(chain):
    row(chain, POSITION_BEFORE)[LAST], row(chain, POSITION)[LAST], row(chain, END_SPEED)[LAST] = (
        1.0,
        1.2,
        1.0,
    )
    update_end_speeds(chain, 0.04, N)  # 5 mm/s, of which it takes 4 parts of 5
    assert row(chain, END_SPEED)[LAST] == pytest.approx(1.0 + 0.8 * 4.0)
    update_end_speeds(chain, math.inf, N)
    assert row(chain, END_SPEED)[LAST] == 0.0


GUIDE = {"load_friction__before_sensor_N": 1.5, "load_friction__after_sensor_N": 3.0}


def test_the_guide_that_is_felt_at_the_load():
    guided = laws(**GUIDE)
    assert moving_friction(at(guided, LOADED_BY_SPRING).load) == 4.5
    assert moving_friction(at(guided, LOADED_BY_FORCE).load) == 1.5
    assert moving_friction(at(guided, LOADED_BY_DISPLACEMENT).load) == 0.0


AT_DRIVE = {"drive_friction__friction_N": 2.0, "proximal_spring__stiffness_N_per_mm": 4.0}


@pytest.mark.parametrize("slip", [1.0, -1.0, 0.0])
def test_where_the_drives_end_is(chain, slip):
    """Driven by force it is where tension, friction and the spring beside the tendon balance."""
    rubs, free = laws(**AT_DRIVE), laws(proximal_spring__stiffness_N_per_mm=4.0)
    chain[SWEEP_P], chain[SWEEP_Q], chain[SWEEP_R], chain[POSITION_BEFORE] = 3.0, 50.0, 2.0, 0.7
    chain[SLIP] = slip
    assert drive_position(chain, NOW, at(rubs, LOADED_BY_SPRING)) == 30.0
    for law, friction in ((rubs, 2.0), (free, 0.0)):
        x = drive_position(chain, NOW, at(law, DRIVEN_BY_FORCE))
        if slip == 0.0 and friction:
            assert x == 0.7
        else:
            tension = (3.0 * x + 50.0) / 2.0
            assert tension + 4.0 * x + slip * friction == pytest.approx(30.0)


def test_an_end_slips_where_it_is_pulled_by_more_than_its_friction(chain):
    for pull, expected in ((2.0, 0), (-2.0, 0), (2.0001, 1), (-2.0001, -1)):
        chain[SLIP] = 0
        assert update_end(0, pull, 2.0, chain, at(laws(), scale=0.01)) == (expected != 0)
        assert chain[SLIP] == expected
    chain[SLIP], chain[POSITION_BEFORE], chain[POSITION] = 1, 0.5, 0.6
    assert not update_end(0, 0.0, 2.0, chain, at(laws(), scale=0.01))
    chain[POSITION] = 0.4
    assert update_end(0, 0.0, 2.0, chain, at(laws(), scale=0.01))
    assert chain[SLIP] == 0


def ends_wrong(chain, boundary, law, *, slip=(0.0, 0.0)):
    """Say whether an end was revised; and return how both slip then."""
    chain[SLIP], row(chain, SLIP)[LAST] = slip
    wrong = update_ends(chain, NOW, at(law, boundary, 0.01))
    return SimpleNamespace(wrong=wrong, slip=(chain[SLIP], row(chain, SLIP)[LAST]))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_drives_end_is_revised_by_all_that_pulls_at_it(chain, sign):
    rubs = laws(**AT_DRIVE)
    row(chain, TENSION)[N] = F0 - 2.0  # the load is in balance at its place 0
    chain[POSITION] = 0.5
    for pull, slips in ((1.9, 0.0), (2.1, sign)):
        chain[TENSION] = 30.0 - 4.0 * 0.5 - sign * pull
        found = ends_wrong(chain, DRIVEN_BY_FORCE, rubs)
        assert (found.wrong, found.slip) == (slips != 0.0, (slips, 0.0))
        found = ends_wrong(chain, LOADED_BY_SPRING, rubs)  # driven by place nothing is asked there
        assert (found.wrong, found.slip) == (False, (0.0, 0.0))
    without = laws(proximal_spring__stiffness_N_per_mm=4.0)
    assert ends_wrong(chain, DRIVEN_BY_FORCE, without).slip == (0.0, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_loads_end_is_revised_by_all_that_pulls_at_it(chain, sign):
    guided = laws(**GUIDE)
    row(chain, POSITION)[LAST] = row(chain, POSITION_BEFORE)[LAST] = x = 2.0
    for boundary, pull, friction in (
        (LOADED_BY_SPRING, F0 - 2.0 + KL * x, 4.5),
        (LOADED_BY_FORCE, 27.0, 1.5),
    ):
        for more, slips in ((-0.1, 0.0), (0.1, sign)):
            row(chain, TENSION)[N] = pull + sign * (friction + more)
            found = ends_wrong(chain, boundary, guided)
            assert (found.wrong, found.slip) == (slips != 0.0, (0.0, slips))
        # One that slips is asked to balance with the whole of its friction.
        assert ends_wrong(chain, boundary, guided, slip=(0.0, sign)).wrong
        row(chain, TENSION)[N] = pull + sign * friction
        assert not ends_wrong(chain, boundary, guided, slip=(0.0, sign)).wrong
        assert ends_wrong(chain, boundary, guided, slip=(0.0, -sign)).wrong
    row(chain, TENSION)[N] = 1e3
    assert not ends_wrong(chain, LOADED_BY_DISPLACEMENT, guided).wrong


def test_a_load_without_a_guide_is_asked_to_balance(chain):
    """To a billionth of the tensions there, which a tangent that is not straight may miss."""
    bare = laws()
    row(chain, POSITION)[LAST] = 2.0
    pull = F0 - 2.0 + KL * 2.0
    for off, wrong in ((0.0, False), (4e-8, False), (6e-8, True), (-6e-8, True)):
        row(chain, TENSION)[N] = pull + off
        assert ends_wrong(chain, LOADED_BY_SPRING, bare).wrong == wrong


def test_a_spring_without_pull_is_where_its_force_is_zero():
    straight = laws().load
    assert unloaded_position(3.0, F0, straight) == pytest.approx(-F0 / KL)
    bent = straight._replace(stiffness_N_per_mm=30.0, nonlinearity=LoadSpringNonlinearity(0.1, 0.2))
    x = unloaded_position(0.0, 10.0, bent)
    assert 30.0 * x * (1.0 + 0.1 * x + 0.2 * x * x) == pytest.approx(-10.0, abs=1e-9)
