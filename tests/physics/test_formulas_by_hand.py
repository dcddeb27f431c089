"""Formulas of the chains' pace, of what is given at the ends, and of the closed form's pieces."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A, LOADED_BY_SPRING, at, bare_step, step_ends, wrap_of
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING
from tsas_cli.physics.bristles import Bristles, bristle_damping, tendon_mass
from tsas_cli.physics.closed_form.branches import from_rest
from tsas_cli.physics.closed_form.capstan import speed_per_stiffness
from tsas_cli.physics.compliances import (
    compliance_at_drive,
    compliance_at_load,
    length_per_angle,
    sheath_compliance,
)
from tsas_cli.physics.course import DRIVE, LOAD, PULLED, RELEASED, STEP, VISCOUS, Losses
from tsas_cli.physics.ends import Drive, ends_of
from tsas_cli.physics.lugre.start import clear_state, lugre_laws
from tsas_cli.physics.lugre.state import PITCH as LUGRE_PITCH
from tsas_cli.physics.lugre.state import ROWS as LUGRE_ROWS
from tsas_cli.physics.lugre.state import TENSION_HISTORY, Formula
from tsas_cli.physics.lugre.step import newton
from tsas_cli.physics.lugre.step_size import Tolerances, fit_to_reversal, step_factor, tolerances_of
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.start import slip_laws
from tsas_cli.physics.slip.state import RATIO_PULLED, RATIO_RELEASED, ROWS, SLIP, TENSION, Moment
from tsas_cli.physics.slip.step import update_active_set

N = 3
EA, F0 = GROUP_A.tendon_stiffness_N, GROUP_A.preload_N
A = wrap_of(GROUP_A)


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


@pytest.mark.parametrize(
    ("f_in", "f_out", "tension"),
    [(-80.0, 60.0, 80.0), (50.0, -90.0, 90.0), (1.0, 1.0, 0.1 * F0)],
)
def test_what_a_step_may_be_off_by_is_a_share_of_the_largest_tension(f_in, f_out, tension):
    law = lugre_laws(GROUP_A, N, LOADED_BY_SPRING)
    found = tolerances_of(step_ends(f_in, f_out), law, 1e-3, 1.0)
    assert found == pytest.approx((1e-3 * tension, 0.3e-3 * tension))
    assert tolerances_of(step_ends(f_in, f_out), law, 1e-3, 1e-5).residual_N == pytest.approx(
        1e-5 * tension
    )
    heavy = law._replace(load=law.load._replace(mass_kg=1.0))
    assert tolerances_of(step_ends(f_in, f_out), heavy, 1e-3, 1.0)[0] < found[0]
    assert tolerances_of(step_ends(f_in, f_out), law, math.inf, 1e-5).error_N == math.inf


FIRST = Formula(1.0, math.inf, math.inf, 1.0, 1.0, 0.0)
THIRD = FIRST._replace(h1=1.0, h2=1.0)


@pytest.mark.parametrize(
    ("off", "formula", "change"),
    [
        (1.0, FIRST, 0.85),  # as far off as it may be
        (1.0, THIRD, 0.85),
        (4.0, FIRST, 0.85 / 2.0),  # the root, and the cubic one where two steps are known
        (8.0, THIRD, 0.85 / 2.0),
        (100.0, FIRST, 0.25),
        (0.0, THIRD, 2.0),
        (math.inf, THIRD, 0.25),
    ],
)
def test_the_next_step_follows_from_the_error_of_this_one(off, formula, change):
    assert step_factor(off, Tolerances(1.0, 1.0), formula) == pytest.approx(change)


@pytest.mark.parametrize(
    ("h", "step", "lands"),
    [
        *((0.4, 0.4, False), (0.5, 0.5, False), (0.6, 0.5, False), (0.9999, 0.5, False)),
        *((1.0, 1.0, True), (1.0 - 1e-10, 1.0, True), (3.0, 1.0, True)),
    ],
)
def test_a_step_lands_on_a_turn_and_leaves_no_short_rest(h, step, lands):
    assert fit_to_reversal(h, 1.0) == (step, lands)


def test_newtons_method_gives_up_at_once_where_forces_outgrow_a_float():
    s, law = np.zeros(LUGRE_ROWS * LUGRE_PITCH), lugre_laws(GROUP_A, N, LOADED_BY_SPRING)
    clear_state(s, GROUP_A, N)
    s[TENSION_HISTORY : TENSION_HISTORY + 2] = 1.5e308, -1.5e308
    step = bare_step(gh=1e-3, pulled=0.1, released=0.1)
    with np.errstate(all="ignore"):
        assert newton(s, step, at(law, LOADED_BY_SPRING), 1e-6) == (0, False)


def test_compliances_in_series():
    rig = with_values(
        GROUP_A,
        {
            "free_tendon.proximal_length_mm": 120.0,
            "free_tendon.distal_length_mm": 30.0,
            "drive_compliance.compliance_mm_per_N": 0.004,
            "sheath_compression.compliance_ratio": 0.5,
        },
    )
    assert compliance_at_drive(rig) == pytest.approx(120.0 / EA + 0.004)
    assert compliance_at_load(rig) == pytest.approx(30.0 / EA)
    assert sheath_compliance(rig) == pytest.approx(1.5 * rig.sheath_length_mm / EA)


@pytest.mark.parametrize(("slope", "bow"), [(0.3, 0.0), (0.0, 0.4), (-0.2, 0.1)])
def test_an_uneven_bend_leaves_the_whole_length_as_it_is(slope, bow):
    """Legendre's polynomials: ends by hand, and a mean of 1 by Simpson's rule."""
    rig = GROUP_A._replace(bend_slope=slope, bend_bow=bow)
    start, middle, end = (length_per_angle(place, rig) for place in (-1.0, 0.0, 1.0))
    assert (start, end) == pytest.approx((1.0 - slope + bow, 1.0 + slope + bow))
    assert (start + 4.0 * middle + end) / 6.0 == pytest.approx(1.0)


def test_mass_and_critical_damping_of_the_bristles():
    """2.5 g/m over 800 mm are 2 g; 2 √(k m), k the bristles in series with Dahl's travel."""
    assert tendon_mass(Bristles(), 800.0) == pytest.approx(2e-6)
    told = Bristles(damping_N_s_per_mm=3.0)
    assert bristle_damping(told, 800.0, 10.0, 0.01) == 3.0
    k = 1.0 / (1.0 / 5000.0 + 0.01 / 10.0)
    assert bristle_damping(Bristles(), 800.0, 10.0, 0.01) == pytest.approx(
        2.0 * math.sqrt(k * 2e-6)
    )
    straight = bristle_damping(Bristles(), 800.0, 0.0, 0.01)
    assert straight == pytest.approx(2.0 * math.sqrt(5000.0 * 2e-6))


def test_the_drives_speed_is_a_turn_of_its_table_for_so_many_of_the_motor():
    """120 turns a minute are one turn of the table, 2π r1."""
    assert 120.0 * speed_per_stiffness(27.1, 120.0) == pytest.approx(2.0 * math.pi * 27.1 / 60.0)


@pytest.mark.parametrize("tension", [0.3, 0.8, 1.0, 1.1, 1.4])
@pytest.mark.parametrize("c", [0.0, 0.02])
def test_from_rest_a_pull_gives_back_the_travel_that_it_takes(tension, c):
    """Travel/F0 = c (e^y − 1) ± C (e^y − 1 − y) of y = ln(T0/F0)."""
    C, y = 0.05, math.log(tension)
    bent = math.copysign(C * (tension - 1.0 - y), y) if y else 0.0
    travel = F0 * (c * (tension - 1.0) + bent)
    assert from_rest(travel, F0, C, c, 1.5) == pytest.approx(F0 * tension, rel=1e-7)


TIME_S = np.array([1.0, 1.5, 3.0])
LEVELS = np.array([4.0, 6.0, 3.0])


def test_a_course_by_displacement_has_speeds_steps_and_the_last_directions():
    rig = with_values(
        GROUP_A._replace(x_in_zero_mm=1.0), {"viscous_friction.coefficient_N_s_per_mm": 0.5}
    )
    found = ends_of(rig, Drive(LEVELS, time_s=TIME_S))
    assert found.boundary == (DISPLACEMENT, SPRING)
    np.testing.assert_allclose(found.drive, [3.0, 5.0, 2.0])
    np.testing.assert_allclose(found.course[LOAD], 0.0)
    np.testing.assert_allclose(found.course[[PULLED, RELEASED]], A)
    # Speeds of 2 mm/s up, then 2 mm/s down; in between weighed by the other side's time.
    np.testing.assert_allclose(np.abs(found.course[VISCOUS]), 0.5 * np.array([4.0, 2.5, 2.0]))
    np.testing.assert_allclose(found.course[STEP], [math.inf, 0.5, 1.5])
    np.testing.assert_array_equal(found.direction, [0.0, 1.0, -1.0])
    still = ends_of(rig, Drive(LEVELS))
    assert not still.course[VISCOUS].any()
    assert np.isinf(still.course[STEP]).all()
    assert found.first().course.shape == (8, 1)
    assert found.first().direction.shape == (1,)


def test_a_course_by_force_is_free_of_the_sensors_errors():
    rig = with_values(
        GROUP_A._replace(x_out_zero_mm=0.5),
        {"force_sensor_offset.f_in_offset_N": 2.0, "force_sensor_offset.f_out_offset_N": -1.0},
    )
    pulled = ends_of(rig, Drive(LEVELS, kind="force", load="force", load_values=2.0 * LEVELS))
    assert pulled.boundary == (FORCE, FORCE)
    np.testing.assert_allclose(pulled.course[[DRIVE, LOAD]], [LEVELS - 2.0, 2.0 * LEVELS + 1.0])
    placed = ends_of(rig, Drive(LEVELS, load="displacement", load_values=LEVELS))
    assert placed.boundary == (DISPLACEMENT, DISPLACEMENT)
    np.testing.assert_allclose(placed.course[LOAD], LEVELS - 0.5)


def test_a_run_goes_on_with_the_play_and_the_direction_that_it_had():
    """A play of 2 mm: the tendon's end stays while the drive crosses it."""
    rig = with_values(GROUP_A, {"backlash.play_mm": 2.0})
    begun = ends_of(rig, Drive(LEVELS))
    np.testing.assert_allclose(begun.drive, [4.0, 5.0, 4.0])
    goes_on = ends_of(rig, Drive(LEVELS), (4.5, -1.0))
    np.testing.assert_allclose(goes_on.drive, [4.5, 5.0, 4.0])
    np.testing.assert_array_equal(goes_on.direction, [-1.0, 1.0, -1.0])
