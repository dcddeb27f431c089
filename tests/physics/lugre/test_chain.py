"""The dynamic chain: its input, its equations, its order, its energy."""

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from tests.physics.lugre.lumps import run
from tests.physics.references import (
    GROUP_A,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    TABLE_1,
    course_of,
)
from tsas_cli.effects import Effects, StribeckFriction
from tsas_cli.physics.course import LOAD
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.lugre.input import DRIVE, next_reversal, value_at
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.lugre.state import DIAGONAL, INCREMENT, LOWER, RESIDUAL, ROWS, UPPER
from tsas_cli.physics.lugre.tridiagonal import solve
from tsas_cli.physics.mesh import MOST_NODES, PITCH

TIGHT = 1e-7
TIME_S = np.arange(0.0, 4.8, 1e-3)
SINE = 10.0 - 10.0 * np.cos(TIME_S)


def follow(x, times=TIME_S, *, rig=TABLE_1, n=50, tolerance=5e-5, steps=OWN_STEPS):
    output, progress = run(x, times, rig=rig, n=n, tolerance=tolerance, steps=steps)
    return np.array(output[:4]), output.phase, progress


@pytest.mark.parametrize("n", [2, 3, 50, 51, MOST_NODES])
def test_newtons_equations_are_solved(n):
    rng = np.random.default_rng(n)
    lower, upper = -rng.uniform(0.5, 1.5, (2, n + 2))
    lower[0] = upper[-1] = 0.0
    diagonal = -lower - upper + rng.uniform(0.0, 0.1, n + 2) ** 2
    rest = rng.standard_normal(n + 2)
    s = np.empty(ROWS * PITCH)
    for row, values in ((LOWER, lower), (UPPER, upper), (DIAGONAL, diagonal), (RESIDUAL, rest)):
        s[row : row + n + 2] = values
    solve(s, n)
    matrix = np.diag(diagonal) + np.diag(lower[1:], -1) + np.diag(upper[:-1], 1)
    expected = np.linalg.solve(matrix, rest)
    assert s[INCREMENT : INCREMENT + n + 2] == pytest.approx(expected, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_between_samples_the_input_is_the_monotone_cubic(seed):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.001, 0.02, 30))
    values = np.round(np.cumsum(rng.standard_normal(30)), 1)
    values[10:13] = values[10]
    course = course_of(values, GROUP_A, time_s=times)
    curve = PchipInterpolator(times, values)
    for t in rng.uniform(times[0], times[-1], 200):
        k = int(np.searchsorted(times, t)) - 1
        value, slope = value_at(course, DRIVE, k, t)
        assert value == pytest.approx(curve(t), abs=1e-10)
        assert slope == pytest.approx(curve.derivative()(t), abs=1e-7)


def test_a_step_ends_where_the_input_turns_stops_or_sets_off():
    values = np.array([0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 0.0, 3.0, 4.0])
    course = course_of(values, GROUP_A)
    found, k = [], 0
    while k < values.size - 1:
        k = next_reversal(course, k, lugre_laws(GROUP_A, 3, LOADED_BY_SPRING))
        found.append(k)
    assert found == [2, 4, 6, 8]


def test_the_integrator_is_of_second_order():
    """In the dead band after a turn, where everything moves; with steps of equal length."""
    dead_band = (math.pi + 0.02 < TIME_S) & (math.pi + 0.2 > TIME_S)
    exact = follow(SINE, tolerance=TIGHT)[0][2, dead_band]

    def off(h):
        found = follow(SINE, steps=np.arange(h, TIME_S[-1], h))[0][2, dead_band]
        return np.sqrt(np.mean((found - exact) ** 2))

    assert off(8e-3) < 0.05
    assert 3.2 < off(8e-3) / off(4e-3) < 5.0
    assert 3.2 < off(6e-3) / off(3e-3) < 5.0


def test_the_mesh_is_of_second_order():
    exact = follow(SINE, n=320, tolerance=TIGHT)[0][2]
    off = [
        np.sqrt(np.mean((follow(SINE, n=n, tolerance=TIGHT)[0][2] - exact) ** 2))
        for n in (10, 20, 40)
    ]
    assert off[0] < 0.05 * np.ptp(exact)
    assert 3.3 < off[0] / off[1] < 4.7
    assert 3.3 < off[1] / off[2] < 4.7


def test_a_run_is_followed_from_where_its_samples_are():
    """Whether it is sampled at 1 kHz, at 125 Hz, or unevenly."""
    exact = follow(SINE)[0]
    few = np.arange(0, TIME_S.size, 8)
    assert np.abs(follow(SINE[few], TIME_S[few])[0] - exact[:, few]).max() < 0.06
    uneven = np.sort(np.random.default_rng(1).choice(TIME_S.size, 2000, replace=False))
    uneven[0] = 0
    assert np.abs(follow(SINE[uneven], TIME_S[uneven])[0] - exact[:, uneven]).max() < 0.06


def test_a_sliding_tendon_that_friction_pushes_on_is_given_up_with_a_reason():
    """Friction that falls steeply with speed: the tendon sticks and slips at its own frequency."""
    rig = GROUP_A._replace(effects=Effects(stribeck_friction=StribeckFriction(0.5, 5.0)))
    columns, phase, progress = follow(SINE[::20], TIME_S[::20], rig=rig)
    assert progress.reached_s < 4.7
    given_up = progress.reached_s < TIME_S[::20]
    assert np.array_equal(phase == 3, given_up)
    assert np.all(np.isfinite(columns))


@pytest.mark.parametrize(("boundary", "row"), [(LOADED_BY_SPRING, DRIVE), (LOADED_BY_FORCE, LOAD)])
def test_a_bump_of_what_is_given_is_not_stepped_over(boundary, row):
    """At either end, in full slip and without a turn: it runs ahead and is back after 40 ms."""
    times = np.arange(0.0, 3.0, 1e-3)
    smooth = 5.0 - 5.0 * np.cos(times)
    given = {DRIVE: smooth, LOAD: 25.0 + 1.5 * smooth}
    given[row] = given[row] + 0.04 * np.exp(-(((times - 1.503) / 0.014) ** 2))
    assert np.all(np.diff(given[row]) > 0.0)

    def f_in(steps):
        call = {"boundary": boundary, "load": given[LOAD], "n": 50, "tolerance": 2e-5}
        return run(given[DRIVE], times, rig=TABLE_1, steps=steps, **call)[0].f_in

    fine = f_in(np.arange(2e-4, 3.0, 2e-4))
    assert np.max(np.abs(fine - f_in(OWN_STEPS))[1000:2000]) < 2e-4 * np.max(fine)
