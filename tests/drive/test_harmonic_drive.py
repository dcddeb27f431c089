"""The harmonic drive against its differential equations, integrated by a general solver."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tsas_cli.drive.harmonic_drive import (
    DriveValues,
    free_motion,
    gear_response,
    has_gear,
    lag_coefficients,
    linear_response,
)
from tsas_cli.numerics.linear_response import sampled

STEP_S = 2e-3
TIME_S = STEP_S * np.arange(201)
SPEED = 400.0 * np.sin(9.0 * TIME_S) + 150.0 * np.sin(31.0 * TIME_S)
WHOLE = DriveValues(
    gain_mm_per_s_rpm=0.02365,
    motor_lag_s=0.011,
    delay_s=8e-3,
    leak_per_s=0.4,
    natural_frequency_Hz=12.0,
    damping_ratio=0.3,
)
PARTS = {
    "a stiff drive without lag": WHOLE._replace(motor_lag_s=0.0, natural_frequency_Hz=0.0),
    "a stiff drive": WHOLE._replace(natural_frequency_Hz=0.0),
    "a motor without lag": WHOLE._replace(motor_lag_s=0.0),
    "no leak": WHOLE._replace(leak_per_s=0.0),
    "no delay": WHOLE._replace(delay_s=0.0),
    "all of it": WHOLE,
}


def integrated(values):
    """Return the motor's place where a stiff drive would be, and x_in, from rest."""

    def asked(t):
        return np.interp(t - values.delay_s, TIME_S, SPEED) if t >= values.delay_s else 0.0

    w = 2.0 * math.pi * values.natural_frequency_Hz

    def rates(t, state):
        speed, motor, x, v = state
        if values.motor_lag_s > 0.0:
            faster, turns = (asked(t) - speed) / values.motor_lag_s, speed
        else:
            faster, turns = 0.0, asked(t)
        moves = values.gain_mm_per_s_rpm * turns - values.leak_per_s * motor
        return faster, moves, v, pull(values, motor, x, v)

    found = from_rest(rates, 4, rtol=1e-7, atol=1e-9)
    return found[1], found[2] if w else found[1]


def pull(values, motor, x, v):
    """Return the acceleration of the end by a spring of the drive's frequency, and its damping."""
    w = 2.0 * math.pi * values.natural_frequency_Hz
    return w * w * (motor - x) - 2.0 * values.damping_ratio * w * v


def from_rest(rates, states, **tolerances):
    span, begin = (0.0, TIME_S[-1]), np.zeros(states)
    return solve_ivp(rates, span, begin, t_eval=TIME_S, max_step=2e-3, **tolerances).y


@pytest.mark.parametrize("values", PARTS.values(), ids=PARTS.keys())
def test_a_perfect_gear_answers_as_the_equations_say(values):
    _, exact = integrated(values)
    answer = linear_response(sampled(STEP_S, SPEED, "first"), values)
    np.testing.assert_allclose(answer, exact, atol=1e-5 * np.ptp(exact))


def test_the_lags_are_those_of_motor_and_spring():
    """(τs + 1)(s²/ω² + 2ζs/ω + 1) at any s; what is zero is not there."""
    s, w = 0.7 - 2.0j, 2.0 * math.pi * 12.0
    expected = (0.011 * s + 1.0) * (s * s / (w * w) + 0.6 * s / w + 1.0)
    lags = lag_coefficients(WHOLE)
    assert np.polynomial.polynomial.polyval(s, lags) == pytest.approx(expected)
    assert lag_coefficients(PARTS["a stiff drive"]).tolist() == [1.0, 0.011]


@pytest.mark.parametrize("start_mm", [0.0, 0.37])
@pytest.mark.parametrize("play_mm", [0.0, 0.05])
@pytest.mark.parametrize("part", ["a stiff drive without lag", "a stiff drive", "all of it"])
def test_the_gear_turns_unevenly_and_has_play(part, play_mm, start_mm):
    """Two waves a turn of the motor, which goes 60 gain millimetres; then play, then the spring."""
    values = PARTS[part]._replace(sine_mm=0.03, cosine_mm=-0.02, play_mm=play_mm)
    stiff, _ = integrated(values)
    angle = 2.0 * math.pi * (start_mm + stiff) / (60.0 * values.gain_mm_per_s_rpm / 2.0)
    first = angle[0]
    wave = 0.03 * (np.sin(angle) - np.sin(first)) - 0.02 * (np.cos(angle) - np.cos(first))
    place, off = 0.0, []
    for moved, way in zip(stiff + wave, stiff, strict=True):
        place = min(max(place, moved - play_mm / 2.0), moved + play_mm / 2.0)
        off.append(place - way)
    if values.natural_frequency_Hz:

        def rates(t, y):
            return y[1], pull(values, np.interp(t, TIME_S, off), *y)

        off = from_rest(rates, 2, rtol=1e-8, atol=1e-11)[0]
    answer = gear_response(sampled(STEP_S, SPEED, "first"), values, start_mm)
    np.testing.assert_allclose(answer, off, atol=2e-4 * np.ptp(off))
    assert np.ptp(off) > 0.02


def test_what_is_not_said_of_a_drive_is_not_there():
    """No lag, delay, leak, spring, damping, waves or play: speed is all that is added up."""
    plain = DriveValues(0.5)
    assert lag_coefficients(plain).tolist() == [1.0]
    answer = linear_response(sampled(0.1, np.array([0.0, 2.0, 2.0, 4.0]), "first"), plain)
    np.testing.assert_allclose(answer, [0.0, 0.05, 0.15, 0.3])
    w = 2.0 * math.pi * 12.0
    undamped = lag_coefficients(plain._replace(natural_frequency_Hz=12.0))
    np.testing.assert_allclose(undamped, [1.0, 0.0, 1.0 / w**2])


def test_what_makes_a_gear_imperfect():
    assert not has_gear(WHOLE)
    for name in ("sine_mm", "cosine_mm", "play_mm"):
        assert has_gear(WHOLE._replace(**{name: -0.01}))


@pytest.mark.parametrize("values", PARTS.values(), ids=PARTS.keys())
def test_a_drive_that_does_not_begin_at_rest_goes_on_by_its_own_motions(values):
    """Each of their sums solves the equations without input; here an end is let go of at 0.2 mm."""
    lags, a = lag_coefficients(values), values.leak_per_s
    columns = free_motion(sampled(STEP_S, 0.0 * SPEED, "first"), values)
    roots = [*np.roots(lags[::-1]), *([-a] if a else [])]
    assert columns.shape == (TIME_S.size, len(roots))
    for root in roots:
        alone = np.real(np.exp(root * TIME_S))
        left = alone - columns @ np.linalg.lstsq(columns, alone, rcond=None)[0]
        assert np.abs(left).max() < 1e-6
