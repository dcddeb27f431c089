"""Parts of the slip chain, each called alone: ratios, losses, phases, sensors, the active set."""

import math

import numpy as np
import pytest

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    course_of,
    wrap_of,
)
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.physics.course import Losses
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.chain import between, initial_state, phase_of, tension_at_sensor
from tsas_cli.physics.slip.nodes import capstan_ratio, is_linear, set_friction
from tsas_cli.physics.slip.start import slip_laws
from tsas_cli.physics.slip.state import (
    POSITION,
    RATIO_PULLED,
    RATIO_RELEASED,
    ROWS,
    SLIP,
    TENSION,
    WRAP_PULLED,
    WRAP_RELEASED,
    Moment,
)
from tsas_cli.physics.slip.step import update_active_set

N = 3


@pytest.mark.parametrize("most", [1, 2, 3])
@pytest.mark.parametrize(("tensions", "way"), [((8, 4, 2, 1), 1.0), ((1, 2, 4, 8), -1.0)])
def test_nodes_are_freed_one_after_the_other_from_the_drive_on(tensions, way, most):
    """Each leaves at least 0.8 and at most 1/0.8 of the tension: all three are too weak."""
    chain = np.zeros(ROWS * PITCH)
    chain[TENSION : TENSION + N + 1] = tensions
    chain[RATIO_PULLED + 1 : RATIO_PULLED + N + 1] = chain[
        RATIO_RELEASED + 1 : RATIO_RELEASED + N + 1
    ] = 0.8
    now = Moment(0.0, 0.0, Losses(0.0, 0.0, 0.0, 0.0), 1.0)
    assert (
        update_active_set(chain, now, at(slip_laws(GROUP_A, N, LOADED_BY_SPRING), scale=1.0), most)
        == most
    )
    freed = chain[SLIP : SLIP + N + 2].tolist()
    assert freed == [0.0, *[way] * most, *[0.0] * (N - most), 0.0]
    strong = chain.copy()
    strong[SLIP : SLIP + N + 2] = 0.0
    strong[RATIO_PULLED + 1 : RATIO_PULLED + N + 1] = strong[
        RATIO_RELEASED + 1 : RATIO_RELEASED + N + 1
    ] = 0.4
    assert (
        update_active_set(strong, now, at(slip_laws(GROUP_A, N, LOADED_BY_SPRING), scale=1.0), most)
        == 0
    )
    assert not strong[SLIP : SLIP + N + 2].any()


RISING = "load_dependent_friction.exponent"


def test_a_part_of_the_way_is_a_straight_line_and_the_end_exact():
    start = Moment(1.0, 2.0, Losses(3.0, 4.0, 5.0, 6.0), 7.0)
    end = Moment(2.0, 4.0, Losses(6.0, 8.0, 10.0, 12.0), 14.0)
    quarter = between(start, end, 0.25, 0.5)
    assert (quarter.drive, quarter.load, quarter.step_s) == pytest.approx((1.25, 2.5, 0.5))
    assert quarter.losses == pytest.approx((3.75, 5.0, 6.25, 7.5))
    assert between(start, end, 1.0, 0.5) == (*end[:-1], 0.5)


def chain_of(*tensions):
    chain = np.zeros(ROWS * PITCH)
    chain[TENSION : TENSION + len(tensions)] = tensions
    return chain


@pytest.mark.parametrize("exponent", [0.0, 0.5, -0.5, 1.0, -1.0])
def test_what_a_node_leaves_depends_on_the_mean_tension_beside_it(exponent):
    """e^(−a (T/F0)^n / 3), at twice the preload on the drive's side of the first node."""
    F0 = GROUP_A.preload_N
    chain = chain_of(2.0 * F0, 2.0 * F0, F0, 0.5 * F0, 77.0)
    laws = slip_laws(with_values(GROUP_A, {RISING: exponent}), N, LOADED_BY_SPRING)
    set_friction(chain, Moment(0.0, 0.0, Losses(0.6, 0.3, 0.0, 0.0), 1.0), laws)
    factors = np.array([2.0, 1.5, 0.75]) ** exponent
    nodes = slice(1, N + 1)
    np.testing.assert_allclose(chain[WRAP_PULLED:][nodes], 0.2 * factors)
    np.testing.assert_allclose(chain[WRAP_RELEASED:][nodes], 0.1 * factors)
    np.testing.assert_allclose(chain[RATIO_PULLED:][nodes], np.exp(-0.2 * factors))
    np.testing.assert_allclose(chain[RATIO_RELEASED:][nodes], np.exp(-0.1 * factors))
    for row in (WRAP_PULLED, WRAP_RELEASED, RATIO_PULLED, RATIO_RELEASED):
        assert not chain[row]
        assert not chain[row + N + 1]


@pytest.mark.parametrize(
    "bent",
    [
        {RISING: 0.1},
        {RISING: -1.0},
        {"presliding.length_mm": 0.1},
        {"load_inertia.mass_kg": 1.0},
        {"load_spring_nonlinearity.quadratic_per_mm": 0.1},
        {"load_spring_nonlinearity.cubic_per_mm2": -0.1},
    ],
)
def test_what_makes_a_chain_more_than_a_set_of_slipping_nodes(bent):
    assert is_linear(slip_laws(GROUP_A, N, LOADED_BY_SPRING))
    assert not is_linear(slip_laws(with_values(GROUP_A, bent), N, LOADED_BY_SPRING))


@pytest.mark.parametrize(
    ("direction", "tensions", "passed"),
    [
        (1.0, (4.0, 2.0), 0.5),  # pulling, what is released plays no part
        (-1.0, (4.0, 2.0), 5.0),
        (1.0, (-4.0, -2.0), 2.0),  # under compression the other way round
        (-1.0, (-4.0, -2.0), 0.2),
        (1.0, (-1.0, 1.0), 0.5),
    ],
)
def test_a_node_passes_on_its_ratio_or_the_inverse(direction, tensions, passed):
    chain = chain_of(*tensions)
    chain[RATIO_PULLED + 1], chain[RATIO_RELEASED + 1] = 0.5, 0.2
    assert capstan_ratio(direction, 1, chain) == pytest.approx(passed)


def test_all_nodes_of_the_sheath_make_a_phase_and_the_ends_do_not():
    for slips, phase in (((1, 1, 1), 1), ((-1, -1, -1), -1), ((1, 1, 0), 0), ((0, 1, 1), 0)):
        chain = chain_of()
        chain[SLIP] = chain[SLIP + N + 1] = 5.0
        chain[SLIP + 1 : SLIP + N + 1] = slips
        assert phase_of(chain, N) == phase


def test_a_sensor_at_the_load_feels_the_tension_less_what_rubs_before_it():
    now = Moment(0.0, 40.0, Losses(0.4, 0.4, 0.0, 0.0), math.inf)
    plain = slip_laws(GROUP_A, N, LOADED_BY_SPRING)
    chain = chain_of(9.0, 9.0, 9.0, 30.0, 9.0)
    chain[SLIP + N + 1] = -1.0
    assert tension_at_sensor(chain, now, at(plain, LOADED_BY_FORCE)) == 40.0
    assert tension_at_sensor(chain, now, at(plain, LOADED_BY_SPRING)) == 30.0
    before = {"load_friction.before_sensor_N": 3.0}
    rubs = slip_laws(with_values(GROUP_A, before), N, LOADED_BY_SPRING)
    assert tension_at_sensor(chain, now, at(rubs, LOADED_BY_DISPLACEMENT)) == 33.0
    # The spring pulls with the preload and k x; of 30 N less that, 3 of 4 N rub before.
    after = slip_laws(
        with_values(GROUP_A, before | {"load_friction.after_sensor_N": 1.0}),
        N,
        LOADED_BY_SPRING,
    )
    chain[POSITION + N + 1] = 2.0
    back = GROUP_A.preload_N + 2.0 * GROUP_A.load_stiffness_N_per_mm
    felt = tension_at_sensor(chain, now, at(after, LOADED_BY_SPRING))
    assert felt == pytest.approx(30.0 - 0.75 * (30.0 - back))


@pytest.mark.parametrize(
    ("boundary", "given"),
    [
        (LOADED_BY_SPRING, (0.0, 0.0)),
        (LOADED_BY_FORCE, (0.0, GROUP_A.preload_N)),
        (DRIVEN_BY_FORCE, (GROUP_A.preload_N, 0.0)),
    ],
)
def test_before_a_course_everything_is_at_the_preload(boundary, given):
    state = initial_state(course_of(np.array([1.0, 2.0]), GROUP_A), GROUP_A, boundary, N)
    a = wrap_of(GROUP_A)
    assert state.before.losses == pytest.approx((a, a, 0.0, 0.0))
    assert (state.before.drive, state.before.load, state.before.step_s) == (*given, math.inf)
    np.testing.assert_array_equal(state.chain[TENSION : TENSION + N + 1], GROUP_A.preload_N)
    np.testing.assert_array_equal(state.chain[POSITION : POSITION + N + 2], 0.0)
    assert (*state.ends, state.unconverged) == (0.0, 0.0, 0.0, 0.0, 0)


def test_a_bent_spring_is_bent_by_its_names():
    bent = with_values(
        GROUP_A,
        {
            "load_spring_nonlinearity.quadratic_per_mm": 0.3,
            "load_spring_nonlinearity.cubic_per_mm2": 0.2,
        },
    )
    assert slip_laws(bent, N, LOADED_BY_SPRING).load.nonlinearity == LoadSpringNonlinearity(
        0.3, 0.2
    )
