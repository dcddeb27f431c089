"""The dynamic chain with three lumps: its equations piece by piece, and a general solver's run."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.lugre_rivals.drives import Sine, Sines
from benchmarks.lugre_rivals.ode import Model, Problem, output, rate
from tests.physics.lugre.lumps import GH, LAST, STEP, N, cleared, nodes, run, segments
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
from tsas_cli.physics.lugre import state as rows
from tsas_cli.physics.lugre.balance import balance
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.lugre.ends import Samples, Span, ends_after, write_cubic
from tsas_cli.physics.lugre.input import DRIVE, Cubic, hermite, hermite_slope, slope_at
from tsas_cli.physics.lugre.state import Given
from tsas_cli.physics.lugre.step import bdf2, predict, step_error
from tsas_cli.physics.rig import with_values

EVERYTHING = {
    "load_dependent_friction.exponent": 0.3,
    "stribeck_friction.excess": 1.0,
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
    "uneven_friction.slope": 1.0,
    "pulley_friction.drive_loss": 0.05,
    "pulley_friction.load_loss": 0.08,
    "sheath_drag.force_N": 2.5,
    "drive_inertia.mass_kg": 0.4,
    "drive_damping.coefficient_N_s_per_mm": 0.7,
    "load_damping.coefficient_N_s_per_mm": 0.8,
    "load_hysteresis.force_N": 2.0,
    "load_hysteresis.travel_mm": 0.5,
    "load_relaxation.share": 0.5,
    "load_relaxation.time_s": 0.01,
    "load_ripple.sine_mm": 0.1,
    "load_ripple.period_mm": 4.0,
}
LIVELY = with_values(GROUP_A, EVERYTHING)
BOUNDARIES = [LOADED_BY_SPRING, LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT, DRIVEN_BY_FORCE]


@pytest.fixture
def lively():
    """Lumps that move at random, in the middle of a step, and their laws."""
    rng, (s, law) = np.random.default_rng(5), cleared(LIVELY)
    for row, size in (
        (rows.POSITION_HISTORY, 0.02),
        (rows.SPEED_HISTORY, 1.0),
        (rows.DEFLECTION_HISTORY, 3e-3),
        (rows.RATE, 2.0),
    ):
        nodes(s, row)[:] = size * rng.standard_normal(N + 2)
    nodes(s, rows.TENSION_HISTORY)[:] = 25.0 + 3.0 * rng.standard_normal(N + 2)
    nodes(s, rows.LOAD_STATE_HISTORY)[:2] = 1.2, -0.3
    nodes(s, rows.TENSION_SLOPE)[:] = nodes(s, rows.STIFFNESS) * GH + nodes(s, rows.DAMPING)
    return s, law


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("tension", [25.0, -25.0])
def test_newtons_matrix_is_the_slope_of_what_the_forces_leave(lively, boundary, tension):
    s, law = lively
    nodes(s, rows.TENSION_HISTORY)[:] += tension - 25.0
    speeds = nodes(s, rows.RATE).copy()

    def left(rates):
        nodes(s, rows.RATE)[:] = rates
        balance(s, STEP, at(law, boundary))
        return nodes(s, rows.RESIDUAL).copy()

    nudges = 1e-5 * np.eye(N + 2)
    slopes = np.transpose([(left(speeds + d) - left(speeds - d)) / 2e-5 for d in nudges])
    rest = left(speeds)
    matrix = np.diag(nodes(s, rows.DIAGONAL))
    matrix += np.diag(nodes(s, rows.LOWER)[1:], -1) + np.diag(nodes(s, rows.UPPER)[:-1], 1)
    if boundary.load == LOADED_BY_DISPLACEMENT.load:  # its row is in speeds, with the slope −1
        assert rest[LAST] == pytest.approx(
            (STEP.load.value - s[rows.POSITION_HISTORY + LAST]) / GH - speeds[LAST]
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
def test_what_the_forces_leave_is_newtons_law_of_each_node(lively, boundary):
    s, law = lively
    total = balance(s, STEP, at(law, boundary))
    w, bent = nodes(s, rows.RATE), nodes(s, rows.DEFLECTION_HISTORY)
    x, v = nodes(s, rows.POSITION_HISTORY) + GH * w, w + STEP.frame.rate
    slowed = v - nodes(s, rows.SPEED_HISTORY)
    T_now = segments(s, rows.TENSION_HISTORY) - segments(s, rows.TENSION_SLOPE) * np.diff(w)
    np.testing.assert_allclose(segments(s, rows.TENSION), T_now, rtol=1e-12)
    left = np.zeros(N + 2)
    for i in range(1, N + 1):
        mean = 0.5 * (T_now[i - 1] + T_now[i])
        pulled = bent[i] + GH * v[i] >= 0.0
        limit = (STEP.pulled if pulled else STEP.released) * mean * (mean / 10.0) ** 0.3
        limit *= 1.0 + math.exp(-((v[i] / 2.0) ** 2))
        limit *= 1.0 + (i - 0.5) / N - 0.5
        limit += 2.0 * math.tanh(0.5 * {1: 0.05, N: 0.08}.get(i, 0.0)) * mean + 2.5 / N
        f, z = bristle_by_hand(bent[i], v[i], limit, law.lump.bristle)
        inertia = 0.0025e-6 * LIVELY.sheath_length_mm / N * slowed[i] / GH
        left[i] = T_now[i - 1] - T_now[i] - f - inertia
        assert s[rows.FRICTION + i] == pytest.approx(f, rel=1e-7)
        assert s[rows.DEFLECTION_NEW + i] == pytest.approx(z, rel=1e-7)
    if boundary is DRIVEN_BY_FORCE:
        rubs, _ = bristle_by_hand(bent[0], w[0], 1.5, law.end_bristle)
        slower = w[0] - s[rows.SPEED_HISTORY]  # at a drive by force no frame moves
        left[0] = 30.0 - T_now[0] - 3.0 * x[0] - rubs - 0.7 * w[0] - 0.4e-3 * slower / GH
    else:
        left[0] = -w[0]
    if boundary is LOADED_BY_FORCE:  # the guide's part behind the sensor is not in what it reads
        rubs, _ = bristle_by_hand(bent[LAST], v[LAST], 1.0, law.end_bristle)
        left[LAST] = T_now[N] - 27.0 - rubs
    else:
        rubs, _ = bristle_by_hand(bent[LAST], v[LAST], 3.0, law.end_bristle)
        pull = 25.0 - 1.2 + 1.579 * x[LAST] * (1.0 + 0.1 * x[LAST] + 0.02 * x[LAST] ** 2)
        pull += 1.579 * 0.1 * math.sin(0.5 * math.pi * x[LAST]) + 0.8 * v[LAST]
        stretch = (-0.3 + GH * v[LAST]) / (1.0 + GH / 0.01)  # of the spring that relaxes
        element = min(max(1.2 + 4.0 * GH * v[LAST], -2.0), 2.0)
        pull += element + 0.5 * 1.579 * stretch
        left[LAST] = T_now[N] - pull - rubs - 0.3e-3 * slowed[LAST] / GH
        assert s[rows.LOAD_STATE_NEW :][:2].tolist() == pytest.approx([element, stretch])
    np.testing.assert_allclose(nodes(s, rows.RESIDUAL), left, rtol=1e-6, atol=1e-9)
    assert total == pytest.approx(np.abs(left).sum(), rel=1e-6)


TIMES = pytest.mark.parametrize("times", [(0.0, 0.3, 0.7, 0.8), (0.0, 0.1, 0.2, 0.5)])


def after_polynomial(powers, times):
    """Return lumps that have followed a polynomial of time through three unequal steps."""
    s, law = cleared(GROUP_A)
    curve = np.polynomial.Polynomial(powers)
    scale = np.arange(1.0, N + 3.0)  # another one for each node
    for row, t in zip((rows.POSITION_2, rows.POSITION_1, rows.POSITION), times, strict=False):
        nodes(s, row)[:] = scale * curve(t)
    for row, t in ((rows.SPEED_1, times[1]), (rows.SPEED, times[2])):
        nodes(s, row)[:] = scale * curve.deriv()(t)
    h2, h1, h = np.diff(times)
    formula = bdf2(h, h1, h2)
    predict(s, law, formula)
    return s, law, formula, scale, curve


@TIMES
def test_a_step_follows_a_parabola_exactly(times):
    """BDF2 has no error there, and the guess through three places none either."""
    s, _, (*_, gh, _, _), scale, curve = after_polynomial([0.4, -1.0, 3.0], times)
    w, x = nodes(s, rows.RATE), nodes(s, rows.POSITION_HISTORY)
    speed = scale * curve.deriv()(times[-1])
    np.testing.assert_allclose(w, speed, rtol=1e-10)
    np.testing.assert_allclose(x + gh * w, scale * curve(times[-1]), rtol=1e-10)
    faster = gh * scale * curve.deriv(2)(0.0)
    np.testing.assert_allclose(nodes(s, rows.SPEED_HISTORY) + faster, speed, rtol=1e-10)
    stiffness = segments(s, rows.STIFFNESS)
    np.testing.assert_allclose(
        segments(s, rows.TENSION_HISTORY), 25.0 - stiffness * np.diff(x), rtol=1e-10
    )
    by_speed = stiffness * gh + segments(s, rows.DAMPING)
    np.testing.assert_allclose(segments(s, rows.TENSION_SLOPE), by_speed, rtol=1e-12)


@TIMES
def test_the_error_of_a_step_is_that_of_a_cubic(times):
    """The step solves for the speed; its place is off by what the formula leaves out."""
    s, law, formula, scale, curve = after_polynomial([0.0, 0.0, 0.0, 1.0], times)
    w = nodes(s, rows.RATE)
    nodes(s, rows.RATE_PREDICTED)[:] = w
    assert step_error(s, law, formula) == 0.0
    w[:] = scale * curve.deriv()(times[-1])
    off = nodes(s, rows.POSITION_HISTORY) + formula.gh * w - scale * curve(times[-1])
    expected = np.abs(segments(s, rows.STIFFNESS) * np.diff(off)).max()
    s[rows.INCREMENT + LAST] = 1e9  # what Newton's method has left there is no segment's
    assert step_error(s, law, formula) == pytest.approx(expected, rel=1e-9)


def test_the_ends_after_a_step_have_the_rates_of_their_tensions(lively):
    s, law = lively
    balance(s, STEP, at(law, LOADED_BY_SPRING))
    drive, load, guide = ends_after(s, STEP._replace(frame=Given(4.0, 1.5)), law)
    w, stiffness = nodes(s, rows.RATE), segments(s, rows.STIFFNESS)
    x = nodes(s, rows.POSITION_HISTORY) + GH * w
    falls = stiffness * -np.diff(w)
    assert (drive.x, load.x) == pytest.approx((x[0], x[LAST] + 4.0))
    assert (drive.v, load.v) == (w[0], w[LAST] + STEP.frame.rate)
    assert (drive.tension, load.tension) == (s[rows.TENSION], s[rows.TENSION + N])
    assert (drive.tension_rate, load.tension_rate) == pytest.approx((falls[0], falls[N]))
    assert guide == s[rows.FRICTION + LAST]


CURVE = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])


def cubic(a, b):
    """Return the cubic by its values and slopes at two times."""
    return Cubic(CURVE(a), CURVE.deriv()(a), CURVE(b), CURVE.deriv()(b))


def test_samples_within_a_step_are_read_off_the_cubic_with_its_values_and_rates():
    t, h = 0.4, 0.3
    times, columns = np.linspace(0.0, 1.0, 21), np.zeros((4, 21))
    ends = cubic(t, t + h)
    course = course_of(times, GROUP_A, time_s=times)
    write_cubic(columns, 2, Samples(9, 13), course, Span(t, h), ends)
    np.testing.assert_allclose(columns[2, 9:13], CURVE(times[9:13]), rtol=1e-12)
    assert not np.any(columns[2, [8, 13]])
    for part in (0.0, 0.2, 0.9, 1.0):
        assert hermite(part, h, ends) == pytest.approx(CURVE(t + part * h))
        assert hermite_slope(part, h, ends) == pytest.approx(CURVE.deriv()(t + part * h))


@pytest.mark.parametrize(
    ("drive", "slopes"),  # Fritsch and Butland's means within, a parabola's at the ends
    [
        *(((0, 2, 3), (2.5, 4 / 3, 0.5)), ((0, 1, 5), (0, 1.6, 5.5)), ((0, 1, 1), (1.5, 0, 0))),
        *(((0, 1, -9), (3, 0, -15.5)), ((0, 0, 1), (0, 0, 1.5)), ((0, -1, -5), (0, -1.6, -5.5))),
    ],
)
def test_the_curve_through_samples_keeps_their_shape(drive, slopes):
    course = course_of(drive, GROUP_A, time_s=[0.0, 1.0, 2.0])
    assert [slope_at(course, DRIVE, k) for k in range(3)] == pytest.approx(slopes)


STRIBECK = {"stribeck_friction.excess": 0.05, "stribeck_friction.velocity_mm_per_s": 3.0}
SMALL = with_values(TABLE_1, STRIBECK)


@pytest.fixture(scope="module")
def solved():
    """Pulled for an eighth of a second and let go again: a general solver's answer."""
    model = Model(lumps=N, stribeck_excess=0.05, stribeck_speed_mm_s=3.0)
    drive, times = Sines((Sine(0.5, 8.0 * math.pi),)), np.linspace(0.0, 0.25, 26)
    problem = Problem(model, drive, times)
    how = {"method": "LSODA", "t_eval": times, "rtol": 1e-7, "atol": 1e-9}
    y = solve_ivp(rate, (0.0, 0.25), problem.start(), args=(problem,), **how).y
    return drive, output(problem, y[0], y[1], y[-1])


def small_run(drive, **how):
    times = np.linspace(0.0, 0.25, 51)
    return run(drive.position(times), times, rig=SMALL, tolerance=2e-5, **how)


@pytest.mark.parametrize("steps", [OWN_STEPS, np.arange(5e-4, 0.25, 5e-4)], ids=["own", "given"])
def test_a_run_is_that_of_a_general_solver(solved, steps):
    drive, expected = solved
    found, progress = small_run(drive, steps=steps)
    assert not np.any(found.phase == 3)
    assert progress.reached_s == pytest.approx(0.25)
    for name in ("x_out", "f_in", "f_out"):
        values = getattr(expected, name + ("_mm" if name == "x_out" else "_N"))
        np.testing.assert_allclose(getattr(found, name)[::2], values, atol=2e-3 * np.ptp(values))
