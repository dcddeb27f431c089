"""The dynamic chain with three lumps: its equations piece by piece, and a general solver's run.

What Newton's method is given is held against slopes by differences, formulas in time against
polynomials that they are exact for, and whole runs against scipy's solver of the equations as one
reads them (`benchmarks/lugre_rivals/ode.py`).
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.lugre_rivals.drives import Sine, Sines
from benchmarks.lugre_rivals.ode import Model, Problem, output, rate
from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    TABLE_1,
    at,
    course_of,
)
from tsas_cli.physics.bristles import Bristle, Bristles, friction, friction_now
from tsas_cli.physics.course import LOAD
from tsas_cli.physics.frames import empty_frames
from tsas_cli.physics.lugre.balance import balance, residual_sum
from tsas_cli.physics.lugre.chain import (
    OWN_STEPS,
    StepControl,
    lugre_chain,
    sample_after,
    sample_before,
)
from tsas_cli.physics.lugre.ends import Samples, Span, ends_after, interpolation_error, write_cubic
from tsas_cli.physics.lugre.input import DRIVE, Cubic, hermite, hermite_slope, slope_at
from tsas_cli.physics.lugre.start import clear_state, lugre_laws
from tsas_cli.physics.lugre.state import (
    DAMPING,
    DEFLECTION_HISTORY,
    DEFLECTION_NEW,
    DIAGONAL,
    FRICTION,
    INCREMENT,
    LOWER,
    PITCH,
    POSITION,
    POSITION_1,
    POSITION_2,
    POSITION_HISTORY,
    POSITION_NEW,
    RATE,
    RATE_PREDICTED,
    RESIDUAL,
    ROWS,
    SPEED,
    SPEED_1,
    SPEED_HISTORY,
    STIFFNESS,
    TENSION,
    TENSION_HISTORY,
    TENSION_SLOPE,
    UPPER,
    Given,
    Step,
)
from tsas_cli.physics.lugre.step import accept_step, bdf2, largest_increment, predict, step_error
from tsas_cli.physics.rig import with_values

N = 3
LAST = N + 1
EVERYTHING = {
    "load_dependent_friction.exponent": 0.3,
    "stribeck_friction.excess": 0.4,
    "stribeck_friction.velocity_mm_per_s": 2.0,
    "viscous_friction.coefficient_N_s_per_mm": 0.05,
    "presliding.length_mm": 0.01,
    "load_spring_nonlinearity.quadratic_per_mm": 0.1,
    "load_spring_nonlinearity.cubic_per_mm2": 0.02,
    "load_friction.after_sensor_N": 2.0,
    "load_friction.before_sensor_N": 1.0,
    "load_inertia.mass_kg": 0.3,
    "drive_friction.friction_N": 1.5,
    "proximal_spring.stiffness_N_per_mm": 3.0,
}
LIVELY = with_values(GROUP_A, EVERYTHING)
GH = 2e-3
STEP = Step(GH, Given(30.0, 0.0), Given(27.0, 0.0), Given(0.0, 1.5), 0.14, 0.11, 1.2)


@pytest.fixture
def state():
    """Lumps that move at random, in the middle of a step."""
    rng, s = np.random.default_rng(5), np.zeros(ROWS * PITCH)
    law = lugre_laws(LIVELY, N, LOADED_BY_SPRING)
    clear_state(s, LIVELY, N)
    nodes = slice(0, N + 2)
    for row, size in (
        (POSITION_HISTORY, 0.02),
        (SPEED_HISTORY, 1.0),
        (DEFLECTION_HISTORY, 3e-3),
        (RATE, 2.0),
    ):
        s[row:][nodes] = size * rng.standard_normal(N + 2)
    s[TENSION_HISTORY:][nodes] = 25.0 + 3.0 * rng.standard_normal(N + 2)
    s[TENSION_SLOPE:][nodes] = s[STIFFNESS:][nodes] * GH + s[DAMPING:][nodes]
    return s, law


@pytest.mark.parametrize(
    "boundary", [LOADED_BY_SPRING, LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT, DRIVEN_BY_FORCE]
)
@pytest.mark.parametrize("tension", [25.0, -25.0])
def test_newtons_matrix_is_the_slope_of_what_the_forces_leave(state, boundary, tension):
    s, law = state
    s[TENSION_HISTORY : TENSION_HISTORY + N + 2] += tension - 25.0
    speeds = s[RATE : RATE + N + 2].copy()

    def left(rates):
        s[RATE : RATE + N + 2] = rates
        balance(s, STEP, at(law, boundary))
        return s[RESIDUAL : RESIDUAL + N + 2].copy()

    slopes = np.zeros((N + 2, N + 2))
    for i in range(N + 2):
        nudge = np.zeros(N + 2)
        nudge[i] = 1e-5
        slopes[:, i] = (left(speeds + nudge) - left(speeds - nudge)) / 2e-5
    rest = left(speeds)
    matrix = np.diag(s[DIAGONAL : DIAGONAL + N + 2])
    matrix += np.diag(s[LOWER + 1 : LOWER + N + 2], -1) + np.diag(s[UPPER : UPPER + N + 1], 1)
    if boundary.load == LOADED_BY_DISPLACEMENT.load:  # its row is in speeds, with the slope −1
        assert rest[LAST] == pytest.approx(
            (STEP.load.value - s[POSITION_HISTORY + LAST]) / GH - speeds[LAST]
        )
    largest = np.abs(matrix).max(axis=1, keepdims=True)
    assert np.all(np.abs(slopes + matrix) < 1e-5 * largest)


def bristle_by_hand(before, speed, limit, bristle):
    """Solve z = Z + h (v − |v| z/z∞) for z; return friction f = g z/z∞ + σ1 dz/dt + σ2 v, and z."""
    longest = limit / bristle.stiffness + bristle.travel
    z = (before + GH * speed) / (1.0 + GH * abs(speed) / longest)
    dz = (z - before) / GH
    return limit * z / longest + bristle.damping * dz + bristle.viscous * speed, z


@pytest.mark.parametrize("boundary", [LOADED_BY_SPRING, LOADED_BY_FORCE, DRIVEN_BY_FORCE])
def test_what_the_forces_leave_is_newtons_law_of_each_node(state, boundary):
    s, law = state
    total = balance(s, STEP, at(law, boundary))
    w = s[RATE : RATE + N + 2]
    v = w + STEP.frame.rate
    T_now = s[TENSION_HISTORY : TENSION_HISTORY + N + 1] - s[
        TENSION_SLOPE : TENSION_SLOPE + N + 1
    ] * np.diff(w)
    np.testing.assert_allclose(s[TENSION : TENSION + N + 1], T_now, rtol=1e-12)
    left = np.zeros(N + 2)
    for i in range(1, N + 1):
        mean = 0.5 * (T_now[i - 1] + T_now[i])
        pulled = s[DEFLECTION_HISTORY + i] + GH * v[i] >= 0.0
        limit = (STEP.pulled if pulled else STEP.released) * mean * (mean / 25.0) ** 0.3
        limit *= 1.0 + 0.4 * math.exp(-((v[i] / 2.0) ** 2))
        f, z = bristle_by_hand(s[DEFLECTION_HISTORY + i], v[i], limit, law.lump.bristle)
        inertia = 0.0025e-6 * LIVELY.sheath_length_mm / N * (v[i] - s[SPEED_HISTORY + i]) / GH
        left[i] = T_now[i - 1] - T_now[i] - f - inertia
        assert s[FRICTION + i] == pytest.approx(f, rel=1e-7)
        assert s[DEFLECTION_NEW + i] == pytest.approx(z, rel=1e-7)
    if boundary is DRIVEN_BY_FORCE:
        rubs, _ = bristle_by_hand(s[DEFLECTION_HISTORY], w[0], 1.5, law.end_bristle)
        left[0] = 30.0 - T_now[0] - 3.0 * (s[POSITION_HISTORY] + GH * w[0]) - rubs
    else:
        left[0] = -w[0]
    x = s[POSITION_HISTORY + LAST] + GH * w[LAST]
    if boundary is LOADED_BY_FORCE:  # the guide's part behind the sensor is not in what it reads
        rubs, _ = bristle_by_hand(s[DEFLECTION_HISTORY + LAST], v[LAST], 1.0, law.end_bristle)
        left[LAST] = T_now[N] - 27.0 - rubs
    else:
        rubs, _ = bristle_by_hand(s[DEFLECTION_HISTORY + LAST], v[LAST], 3.0, law.end_bristle)
        pull = 25.0 - 1.2 + 1.579 * x * (1.0 + 0.1 * x + 0.02 * x * x)
        left[LAST] = T_now[N] - pull - rubs - 0.3e-3 * (v[LAST] - s[SPEED_HISTORY + LAST]) / GH
    np.testing.assert_allclose(s[RESIDUAL : RESIDUAL + N + 2], left, rtol=1e-6, atol=1e-9)
    assert total == pytest.approx(np.abs(left).sum(), rel=1e-6)


@pytest.mark.parametrize("count", range(1, 10))
def test_sums_and_largest_ones_miss_no_node(count):
    for place in range(count):
        s = np.zeros(ROWS * PITCH)
        s[RESIDUAL + place], s[INCREMENT + place] = -3.0, 3.0
        s[RESIDUAL + count], s[INCREMENT + count] = 7.0, 7.0  # one more is not theirs
        assert residual_sum(s, count) == 3.0
        if count > 1:
            assert largest_increment(s, count) == 3.0


def test_usual_constants_are_those_of_table_1_for_the_whole_sheath():
    """Yang 2025: 100 N/mm for each of 50 lumps, 0.25 kg for 100 m, 0.1 N s/mm for each of 50."""
    usual = Bristles()
    assert usual.stiffness_N_per_mm == pytest.approx(100.0 * 50)
    assert usual.tendon_mass_kg_per_m == pytest.approx(0.25 / 100.0)
    assert usual.tendon_damping_N_s_per_mm == pytest.approx(0.1 / 50)
    assert math.isnan(usual.damping_N_s_per_mm)  # critical: the paper's diverges


@pytest.mark.parametrize("speed", [0.7, -0.7])
def test_friction_now_is_that_of_a_step_of_no_time(speed):
    bristle = Bristle(300.0, 0.5, 0.02, 0.01)
    now, rate_now = friction_now(0.004, speed, 2.0, bristle)
    later, _, _, z = friction(0.004, speed, 1e-9, 2.0, bristle)
    assert now == pytest.approx(later, rel=1e-5)
    assert rate_now == pytest.approx((z - 0.004) / 1e-9, rel=1e-5)
    longest = 2.0 / 300.0 + 0.01
    assert rate_now == pytest.approx(speed * (1.0 - math.copysign(1.0, speed) * 0.004 / longest))


def after_polynomial(powers, times):
    """Return lumps that have followed a polynomial of time through three unequal steps."""
    s, law = np.zeros(ROWS * PITCH), lugre_laws(GROUP_A, N, LOADED_BY_SPRING)
    clear_state(s, GROUP_A, N)
    curve = np.polynomial.Polynomial(powers)
    speed = curve.deriv()
    scale = np.arange(1.0, N + 3.0)  # another one for each node
    for rows, t in (
        ((POSITION_2,), times[0]),
        ((POSITION_1, SPEED_1), times[1]),
        ((POSITION, SPEED), times[2]),
    ):
        s[rows[0] : rows[0] + N + 2] = scale * curve(t)
        if len(rows) > 1:
            s[rows[1] : rows[1] + N + 2] = scale * speed(t)
    h2, h1, h = np.diff(times)
    formula = bdf2(h, h1, h2)
    predict(s, law, formula)
    return s, law, formula, scale, curve


@pytest.mark.parametrize("times", [(0.0, 0.3, 0.7, 0.8), (0.0, 0.1, 0.2, 0.5)])
def test_a_step_follows_a_parabola_exactly(times):
    """BDF2 has no error there, and the guess through three places none either."""
    s, law, formula, scale, curve = after_polynomial([0.4, -1.0, 3.0], times)
    w = s[RATE : RATE + N + 2]
    np.testing.assert_allclose(w, scale * curve.deriv()(times[-1]), rtol=1e-10)
    np.testing.assert_allclose(
        s[POSITION_HISTORY : POSITION_HISTORY + N + 2] + formula.gh * w,
        scale * curve(times[-1]),
        rtol=1e-10,
    )
    np.testing.assert_allclose(
        s[SPEED_HISTORY : SPEED_HISTORY + N + 2] + formula.gh * scale * curve.deriv(2)(0.0),
        scale * curve.deriv()(times[-1]),
        rtol=1e-10,
    )
    stretched = 25.0 - s[STIFFNESS : STIFFNESS + N + 1] * np.diff(
        s[POSITION_HISTORY : POSITION_HISTORY + N + 2]
    )
    np.testing.assert_allclose(s[TENSION_HISTORY : TENSION_HISTORY + N + 1], stretched, rtol=1e-10)
    by_speed = s[STIFFNESS : STIFFNESS + N + 1] * formula.gh + s[DAMPING : DAMPING + N + 1]
    np.testing.assert_allclose(s[TENSION_SLOPE : TENSION_SLOPE + N + 1], by_speed, rtol=1e-12)
    s[RATE_PREDICTED : RATE_PREDICTED + N + 2] = w
    assert step_error(s, law, formula) == 0.0


@pytest.mark.parametrize("times", [(0.0, 0.3, 0.7, 0.8), (0.0, 0.1, 0.2, 0.5)])
def test_the_error_of_a_step_is_that_of_a_cubic(times):
    """The step solves for the speed; its place is off by what the formula leaves out."""
    s, law, formula, scale, curve = after_polynomial([0.0, 0.0, 0.0, 1.0], times)
    nodes = slice(RATE, RATE + N + 2)
    s[RATE_PREDICTED : RATE_PREDICTED + N + 2] = s[nodes]
    s[nodes] = scale * curve.deriv()(times[-1])
    off = (
        s[POSITION_HISTORY : POSITION_HISTORY + N + 2]
        + formula.gh * s[nodes]
        - scale * curve(times[-1])
    )
    expected = np.abs(s[STIFFNESS : STIFFNESS + N + 1] * np.diff(off)).max()
    s[INCREMENT + LAST] = 1e9  # what Newton's method has left there is no segment's
    assert step_error(s, law, formula) == pytest.approx(expected, rel=1e-9)


def test_the_first_step_is_backward_eulers():
    formula = bdf2(0.2, math.inf, math.inf)
    assert (formula.gh, formula.near, formula.far) == (0.2, 1.0, 0.0)


def test_what_is_kept_moves_one_step_back(state):
    s, law = state
    for k, row in enumerate(
        (POSITION, POSITION_1, POSITION_2, SPEED, SPEED_1, POSITION_NEW, DEFLECTION_NEW)
    ):
        s[row : row + N + 2] = 10.0 * k + np.arange(N + 2)
    before = s.copy()
    accept_step(s, STEP, law)

    def row_of(values, row):
        return values[row : row + N + 2]

    for now, then in (
        (POSITION_2, POSITION_1),
        (POSITION_1, POSITION),
        (POSITION, POSITION_NEW),
        (SPEED_1, SPEED),
    ):
        np.testing.assert_array_equal(row_of(s, now), row_of(before, then))
    np.testing.assert_array_equal(row_of(s, SPEED), row_of(before, RATE) + STEP.frame.rate)


def test_the_ends_after_a_step_have_the_rates_of_their_tensions(state):
    s, law = state
    balance(s, STEP, at(law, LOADED_BY_SPRING))
    ends = ends_after(s, STEP._replace(frame=Given(4.0, 1.5)), law)
    w = s[RATE : RATE + N + 2]
    assert ends.drive.tension_rate == pytest.approx(s[STIFFNESS] * (w[0] - w[1]))
    assert ends.load.tension_rate == pytest.approx(s[STIFFNESS + N] * (w[N] - w[LAST]))
    assert ends.drive.x == pytest.approx(s[POSITION_HISTORY] + GH * w[0])
    assert ends.load.x == pytest.approx(s[POSITION_HISTORY + LAST] + GH * w[LAST] + 4.0)
    assert (ends.drive.v, ends.load.v) == (w[0], w[LAST] + STEP.frame.rate)
    assert (ends.drive.tension, ends.load.tension) == (s[TENSION], s[TENSION + N])
    assert ends.guide == s[FRICTION + LAST]


CUBIC = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])


def test_samples_within_a_step_are_read_off_the_cubic_with_its_values_and_rates():
    t, h = 0.4, 0.3
    times, columns = np.linspace(0.0, 1.0, 21), np.zeros((4, 21))
    a, b = t, t + h
    ends = Cubic(CUBIC(a), CUBIC.deriv()(a), CUBIC(b), CUBIC.deriv()(b))
    course = course_of(times, GROUP_A, time_s=times)
    write_cubic(columns, 2, Samples(9, 13), course, Span(t, h), ends)
    np.testing.assert_allclose(columns[2, 9:13], CUBIC(times[9:13]), rtol=1e-12)
    assert not np.any(columns[2, [8, 13]])
    for part in (0.0, 0.2, 0.9, 1.0):
        assert hermite(part, h, ends) == pytest.approx(CUBIC(t + part * h))
        assert hermite_slope(part, h, ends) == pytest.approx(CUBIC.deriv()(t + part * h))


@pytest.mark.parametrize("bumped", [4, 7, 9])
def test_what_leaves_the_cubic_within_a_step_is_seen(bumped):
    """Three of the samples in between are looked at, of eight."""
    times = np.linspace(0.0, 1.0, 12)
    t, h = 0.5 * (times[1] + times[2]), times[10] - 0.5 * (times[1] + times[2])
    ends = Cubic(CUBIC(t), CUBIC.deriv()(t), CUBIC(t + h), CUBIC.deriv()(t + h))
    course = course_of(CUBIC(times), GROUP_A, load=CUBIC(times), time_s=times)
    off = interpolation_error(course, LOAD, Samples(2, 9), Span(t, h), ends)
    assert off == pytest.approx(0.0, abs=1e-12)
    looked_at = 1 + 1 + np.arange(1, 4) * (9 - 1 - 1) // 4
    course[LOAD, bumped] += 0.25
    off = interpolation_error(course, LOAD, Samples(2, 9), Span(t, h), ends)
    assert off == pytest.approx(0.25 if bumped in looked_at else 0.0, abs=1e-12)
    none = Samples(bumped, bumped)
    assert interpolation_error(course, LOAD, none, Span(t, h), ends) == 0.0


def test_an_input_of_one_sample_stands_still():
    assert slope_at(course_of([3.0], GROUP_A), DRIVE, 0) == 0.0


def test_samples_before_and_after_a_time():
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    course = course_of(times, GROUP_A, time_s=times)
    assert [sample_before(course, 0, t) for t in (0.5, 1.0, 1.5, 4.0)] == [0, 0, 1, 3]
    assert sample_before(course, 2, 2.5) == 2
    assert [sample_after(times, 0, t) for t in (-1.0, 0.0, 1.5, 4.0)] == [0, 1, 2, 5]


MODEL = Model(lumps=N, stribeck_excess=0.05, stribeck_speed_mm_s=3.0)
SMALL = with_values(
    TABLE_1,
    {"stribeck_friction.excess": 0.05, "stribeck_friction.velocity_mm_per_s": 3.0},
)


@pytest.fixture(scope="module")
def solved():
    """Pulled for an eighth of a second and let go again: a general solver's answer."""
    problem = Problem(MODEL, Sines((Sine(0.5, 8.0 * math.pi),)), np.linspace(0.0, 0.25, 26))
    found = solve_ivp(
        rate,
        (0.0, 0.25),
        problem.start(),
        method="LSODA",
        t_eval=problem.time_s,
        rtol=1e-7,
        atol=1e-9,
        args=(problem,),
    )
    y, w, y_load = found.y[0], found.y[1], found.y[-1]
    return problem, output(problem, y, w, y_load)


def small_run(problem, steps=OWN_STEPS, frames=None):
    times = np.linspace(0.0, 0.25, 51)
    start = np.zeros((2, N + 2))
    start[1] = SMALL.preload_N
    course = course_of(problem.drive.position(times), SMALL, time_s=times)
    call = (course, start, SMALL, LOADED_BY_SPRING, N, StepControl(2e-5, steps))
    return times, lugre_chain(*call, frames)


@pytest.mark.parametrize("steps", [OWN_STEPS, np.arange(5e-4, 0.25, 5e-4)], ids=["own", "given"])
def test_a_run_is_that_of_a_general_solver(solved, steps):
    problem, expected = solved
    _, (run, progress) = small_run(problem, steps)
    columns, phase = np.array(run[:4]), run.phase
    assert not np.any(phase == 3)
    assert progress.reached_s == pytest.approx(0.25)
    every = columns[:, ::2]
    for row, values in ((1, expected.x_out_mm), (2, expected.f_in_N), (3, expected.f_out_N)):
        np.testing.assert_allclose(every[row], values, atol=2e-3 * np.ptp(values))


def test_along_the_tendon_are_the_tensions_of_its_ends(solved):
    samples = np.array([0, 7, 20, 31, 50])
    frames = empty_frames(samples, N)
    _, (run, _) = small_run(solved[0], frames=frames)
    columns, phase = np.array(run[:4]), run.phase
    np.testing.assert_allclose(frames.tension_N[:, 0], columns[2, samples], rtol=1e-9)
    np.testing.assert_allclose(frames.tension_N[:, -1], columns[3, samples], rtol=1e-9)
    alike = np.all(frames.slip == frames.slip[:, :1], axis=1)
    np.testing.assert_array_equal(np.where(alike, frames.slip[:, 0], 0), phase[samples])
    assert {-1, 1} <= set(phase)
