"""The slip chain at its limits: no tension, a turn within a step, rounding, a margin."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A, LOADED_BY_SPRING, at
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.physics.boundary import unloaded_position
from tsas_cli.physics.course import Losses
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip import state as rows
from tsas_cli.physics.slip.ends import update_ends
from tsas_cli.physics.slip.nodes import breakaway, set_friction, slips_backwards, update_travel
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
    """Its tension counts as a hundredth of the preload, and a node passes on e^−30 at least."""
    chain[rows.TENSION :][: N + 2] = 1e-9
    for exponent, pulled, released in ((-0.5, 0.2 * 10.0, 0.15 * 10.0), (-1.5, 30.0, 30.0)):
        set_friction(chain, NOW, laws({"load_dependent_friction.exponent": exponent}))
        np.testing.assert_allclose(nodes(chain, rows.WRAP_PULLED), pulled)
        np.testing.assert_allclose(nodes(chain, rows.WRAP_RELEASED), released)


def test_a_way_that_would_turn_stops_at_its_turning(chain):
    nodes(chain, rows.POSITION)[:] = 0.02, 0.02, -0.01
    nodes(chain, rows.TRAVEL)[:] = 0.01, 0.0, -0.03
    nodes(chain, rows.SHARE_BEFORE)[:] = 0.5, -0.5, 0.1
    assert not update_travel(chain, BRISTLY)
    assert nodes(chain, rows.TRAVEL).tolist() == [0.02, 0.02, -0.01]
    far, near = math.exp(-0.4), math.exp(-0.2)
    shares = [1.0 - 0.5 * far, 1.0 - 1.5 * far, -1.0 + 1.1 * near]
    np.testing.assert_allclose(nodes(chain, rows.SHARE), shares, rtol=1e-9)
    chain[rows.TRAVEL + 2] = -1e-3
    assert update_travel(chain, BRISTLY)
    assert nodes(chain, rows.TRAVEL).tolist() == [0.02, 0.0, -0.01]
    assert chain[rows.SHARE + 2] == pytest.approx(-0.5)


def test_rounding_turns_no_way_of_a_node_that_rests(chain):
    """Else its step would never settle: the sign of a way of 1e-18 mm changes for ever."""
    nodes(chain, rows.POSITION)[:] = nodes(chain, rows.POSITION_BEFORE) + 1e-15
    nodes(chain, rows.TRAVEL)[:] = -1e-15
    assert not update_travel(chain, BRISTLY)
    assert not nodes(chain, rows.TRAVEL).any()


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


def test_a_load_without_a_guide_is_asked_to_balance(chain):
    """To a billionth of the tensions there, which a tangent that is not straight may miss."""
    chain[rows.POSITION + N + 1] = 2.0
    for off, wrong in ((0.0, False), (4e-8, False), (6e-8, True), (-6e-8, True)):
        chain[rows.TENSION + N] = F0 - 2.0 + KL * 2.0 + off
        assert update_ends(chain, NOW, at(laws(), LOADED_BY_SPRING, 0.01)) == wrong


def test_a_spring_without_pull_is_where_its_force_is_zero():
    straight = laws().load
    assert unloaded_position(3.0, F0, straight) == pytest.approx(-F0 / KL)
    bent = straight._replace(stiffness_N_per_mm=30.0, nonlinearity=LoadSpringNonlinearity(0.1, 0.2))
    x = unloaded_position(0.0, 10.0, bent)
    assert 30.0 * x * (1.0 + 0.1 * x + 0.2 * x * x) == pytest.approx(-10.0, abs=1e-9)
