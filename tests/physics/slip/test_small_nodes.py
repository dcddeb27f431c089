"""The slip chain at its limits: no tension, a turn within a step, rounding, a margin."""

import math

import numpy as np
import pytest

from tests.physics.references import DRIVEN_BY_FORCE, GROUP_A, LOADED_BY_SPRING, at
from tests.physics.slip.laws_by_hand import EFFECTS, BesideSpring
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.physics.boundary import unloaded_position
from tsas_cli.physics.course import Losses
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip import state as rows
from tsas_cli.physics.slip.ends import drive_tangent, load_tangent, update_ends
from tsas_cli.physics.slip.nodes import (
    accept,
    breakaway,
    capstan_ratio,
    is_linear,
    set_friction,
    set_lengths,
    slip_after_backwards,
    slips_backwards,
    update_relations,
    update_travel,
)
from tsas_cli.physics.slip.state import Moment, chain_at_rest, slip_laws

N = 3
F0, KL = 25.0, 1.579
NOW = Moment(30.0, 27.0, Losses(0.6, 0.45, 1.2, 2.0), 0.05)


def laws(values=()):
    return slip_laws(with_values(GROUP_A, dict(values)), N, LOADED_BY_SPRING)


BRISTLY = laws({"presliding.length_mm": 0.05})


@pytest.fixture
def chain():
    """A chain at rest whose tensions fall towards the load."""
    found = chain_at_rest(GROUP_A, N)
    found[rows.TENSION :][: N + 1] = 40.0, 31.0, 22.0, 13.0
    return found


def nodes(chain, row):
    return chain[row + 1 : row + N + 1]


def test_friction_stays_finite_where_no_tension_is_left(chain):
    """Its tension counts as 0.1 N, and a node passes on e^−30 at least."""
    chain[rows.TENSION :][: N + 2] = 1e-9
    for exponent, pulled, released in ((-0.5, 0.2 * 10.0, 0.15 * 10.0), (-1.5, 30.0, 30.0)):
        set_friction(chain, NOW, laws({"load_dependent_friction.exponent": exponent}))
        np.testing.assert_allclose(nodes(chain, rows.WRAP_PULLED), pulled)
        np.testing.assert_allclose(nodes(chain, rows.WRAP_RELEASED), released)


def test_a_way_that_would_turn_stops_at_its_turning(chain):
    nodes(chain, rows.POSITION)[:] = 0.02, 0.02, -0.01
    nodes(chain, rows.TRAVEL)[:] = 0.01, 0.0, -0.03
    nodes(chain, rows.SHARE_BEFORE)[:] = 0.5, -0.5, 0.1
    set_lengths(chain, NOW, BRISTLY)
    assert not update_travel(chain, BRISTLY)
    assert nodes(chain, rows.TRAVEL).tolist() == [0.02, 0.02, -0.01]
    far, near = math.exp(-0.4), math.exp(-0.2)
    shares = [1.0 - 0.5 * far, 1.0 - 1.5 * far, -1.0 + 1.1 * near]
    np.testing.assert_allclose(nodes(chain, rows.SHARE), shares, rtol=1e-9)
    chain[rows.TRAVEL + 2] = -1e-3
    assert update_travel(chain, BRISTLY)
    assert nodes(chain, rows.TRAVEL).tolist() == [0.02, 0.0, -0.01]
    assert chain[rows.SHARE + 2] == pytest.approx(-0.5)


@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_a_node_that_goes_against_its_slip_is_held(chain, slip):
    chain[rows.SLIP + 2] = slip
    chain[rows.POSITION_BEFORE + 2] = 0.3
    for way, back in ((1e-3, False), (0.0, False), (-1e-3, True), (-0.5e-12, False)):
        chain[rows.POSITION + 2] = 0.3 + slip * way
        assert slips_backwards(2, chain, at(laws(), scale=0.01)) == back
    chain[rows.POSITION + 2] = 0.3 - slip * 2e-12
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
        chain[rows.TENSION + 1 :][:2] = before, behind
        assert breakaway(2, 2.0 * half, chain) == expected


def test_a_spring_without_pull_is_where_its_force_is_zero():
    straight = laws().load
    assert unloaded_position(3.0, F0, straight) == pytest.approx(-F0 / KL)
    bent = straight._replace(stiffness_N_per_mm=30.0, nonlinearity=LoadSpringNonlinearity(0.1, 0.2))
    x = unloaded_position(0.0, 10.0, bent)
    assert 30.0 * x * (1.0 + 0.1 * x + 0.2 * x * x) == pytest.approx(-10.0, abs=1e-9)


def test_friction_is_that_of_the_size_of_both_tensions_together(chain):
    """Where they push as a whole, the node passes on more where it goes towards the drive."""
    set_friction(chain, NOW, laws())
    for tensions, sign in (
        ((3.0, -2.0), 1),
        ((2.0, -3.0), -1),
        ((-2.0, 3.0), 1),
        ((-0.2, 0.1), -1),
    ):
        chain[rows.TENSION + 1 :][:2] = tensions
        found = [capstan_ratio(way, 2, chain) for way in (1.0, -1.0)]
        assert found == pytest.approx([math.exp(-0.2 * sign), math.exp(0.15 * sign)])


@pytest.mark.parametrize("slip", [1.0, -1.0])
def test_a_node_that_went_back_rests_unless_both_segments_pull_more_than_its_friction(chain, slip):
    """Before it may be what either way allows to the 22 N behind it."""
    set_friction(chain, NOW, laws())
    chain[rows.SLIP + 2], chain[rows.POSITION_BEFORE + 2] = slip, 0.3
    most, least = (22.0 + 0.2) * math.exp(0.2) + 0.2, (22.0 - 0.2) * math.exp(-0.15) - 0.2
    stiffness = 1.0 / chain[rows.COMPLIANCE + 1] + 1.0 / chain[rows.COMPLIANCE + 2]
    for share, expected in ((0.99, 0.0), (1.01, -slip)):
        chain[rows.POSITION + 2] = 0.3 - slip * share * (most - least) / stiffness
        assert slip_after_backwards(2, 0.4, chain) == expected


@pytest.mark.parametrize("exponent", [0.0, 0.3, -0.4])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("way", [0.02, -0.03])
def test_the_tangent_of_a_node_is_the_slope_of_its_law(chain, exponent, sign, way):
    """By the tension before it and by its way; off its law the tangent leads back to it."""
    values = {"presliding.length_mm": 0.05, "load_dependent_friction.exponent": exponent}
    chain[rows.TENSION :][: N + 1] *= sign
    nodes(chain, rows.POSITION_BEFORE)[:], nodes(chain, rows.POSITION)[:] = 0.3, 0.3 + way
    nodes(chain, rows.SHARE_BEFORE)[:] = 0.25
    set_friction(chain, NOW, laws(values))
    set_lengths(chain, NOW, laws(values))
    assert update_relations(chain, NOW, laws(values))

    def left(before, behind, x):
        limit = math.copysign(1.0, x - 0.3)
        share = limit + (0.25 - limit) * math.exp(-abs(x - 0.3) / 0.05)
        wrap = (0.2 if share > 0.0 else 0.15) * abs((before + behind) / 20.0) ** exponent
        half = 0.5 * share * 0.4
        return behind + half - math.exp(-sign * share * wrap) * (before - half)

    there, nudges = (chain[rows.TENSION + 1], chain[rows.TENSION + 2], 0.3 + way), 1e-5 * np.eye(3)
    by = [(left(*(there + d)) - left(*(there - d))) / 2e-5 for d in nudges]
    factor, drop, slope = chain[[rows.FACTOR + 2, rows.DROP + 2, rows.DROP_SLOPE + 2]]
    assert (factor, slope) == pytest.approx((-by[0] / by[1], by[2] / by[1]), rel=1e-6)
    back = there[1] - left(*there) / by[1]
    assert factor * there[0] - drop - slope * there[2] == pytest.approx(back, rel=1e-6)


@pytest.mark.parametrize("pull", [-1.001, -0.999, 0.999, 1.001])
def test_an_end_breaks_loose_beyond_its_friction(chain, pull):
    """The guide holds 0.4 N and the drive 0.3 N, each to both sides."""
    law = laws({"load_friction.after_sensor_N": 0.4, "drive_friction.friction_N": 0.3})
    slip = math.copysign(1.0, pull) if abs(pull) > 1.0 else 0.0
    for end, boundary in ((N + 1, LOADED_BY_SPRING), (0, DRIVEN_BY_FORCE)):
        chain[rows.TENSION] = NOW.drive - (0.3 * pull if end == 0 else 0.0)
        chain[rows.TENSION + N] = F0 - 2.0 + (0.4 * pull if end else 0.0)
        assert update_ends(chain, NOW, at(law, boundary, 0.01)) == (slip != 0.0)
        assert chain[rows.SLIP + end] == slip


@pytest.mark.parametrize("way", [0.01, 0.4])
def test_the_tangents_of_both_ends_are_the_slopes_of_what_is_there(chain, way):
    """Masses, dampers, a spring that is bent, relaxes and yields after 0.3 mm, a pulley."""
    values = EFFECTS["all at the load"] | EFFECTS["a bent spring"] | {"drive_inertia.mass_kg": 5.0}
    values |= {"drive_damping.coefficient_N_s_per_mm": 0.2, "proximal_spring.stiffness_N_per_mm": 3}
    rig, last, (h, now) = with_values(GROUP_A, values), N + 1, (NOW.step_s, 0.7 + way)
    chain[[rows.POSITION_BEFORE, rows.POSITION_BEFORE + last]] = 0.7
    chain[[rows.SPEED_BEFORE, rows.SPEED_BEFORE + last]] = 3.0
    chain[[rows.POSITION, rows.POSITION + last]] = now
    chain[rows.ELEMENT], chain[rows.STRETCH] = 1.5, 0.3

    def at_load(x):
        beside = BesideSpring(rig)
        beside.element, beside.stretch = 1.5, 0.3
        held = beside.force(x, x - 0.7, h) + KL * x * (1.0 + 0.3 * x + 0.2 * x * x)
        return F0 - 2.0 + held + 10e-3 * ((x - 0.7) / h - 3.0) / (h + 0.004)

    def at_drive(x):
        return 3.0 * x + 0.2 * (x - 0.7) / h + 5e-3 * ((x - 0.7) / h - 3.0) / (h + 0.004)

    for tangent, force in ((load_tangent, at_load), (drive_tangent, at_drive)):
        slope, value = tangent(chain, NOW, slip_laws(rig, N, DRIVEN_BY_FORCE))
        assert slope * now + value == pytest.approx(force(now), rel=1e-9)
        assert slope == pytest.approx((force(now + 1e-6) - force(now - 1e-6)) / 2e-6, rel=1e-5)


@pytest.mark.parametrize(
    "name",
    [
        *("load_dependent_friction.exponent", "load_spring_nonlinearity.quadratic_per_mm"),
        *("presliding.length_mm", "load_spring_nonlinearity.cubic_per_mm2"),
        *("load_inertia.mass_kg", "load_ripple.sine_mm", "load_ripple.cosine_mm"),
        "load_hysteresis.force_N",
    ],
)
def test_a_law_that_bends_is_not_linear(name):
    """Whatever its size; the nominal laws are, and so is a spring beside them."""
    assert is_linear(laws({"load_damping.coefficient_N_s_per_mm": 1.0}))
    assert not any(is_linear(laws({name: size})) for size in (1e-3, 1.0, 2.0))


def test_an_accepted_step_is_the_one_before_and_a_bristle_slides_near_its_limit(chain):
    """The rise of a step is where the next one is begun."""
    shares = [0.999999, -0.999999, 0.9]
    nodes(chain, rows.SHARE)[:] = shares
    chain[rows.POSITION :][: N + 2], chain[rows.POSITION_BEFORE :][: N + 2] = 0.5, 0.2
    before = chain[rows.TENSION_BEFORE :][: N + 2].copy()
    accept(chain, BRISTLY)
    assert nodes(chain, rows.SLIP).tolist() == [1.0, -1.0, 0.0]
    assert nodes(chain, rows.SHARE_BEFORE).tolist() == shares
    np.testing.assert_allclose(chain[rows.TRAVEL :][: N + 2], 0.3)
    np.testing.assert_array_equal(chain[rows.POSITION_BEFORE :][: N + 2], 0.5)
    now = chain[rows.TENSION :][: N + 2]
    np.testing.assert_array_equal(chain[rows.TENSION_BEFORE :][: N + 2], now)
    np.testing.assert_allclose(chain[rows.TENSION_RISE :][: N + 2], now - before)
