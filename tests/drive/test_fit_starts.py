"""Where the fit of a drive starts, how it scales its numbers, and what counts as an error."""

import cmath
import math

import numpy as np
import pytest

from tsas_cli.drive import fit as d
from tsas_cli.drive.harmonic_drive import DriveValues, gear_response, linear_response
from tsas_cli.drive.runs import DriveRun
from tsas_cli.numerics.linear_response import sampled

STEP_S = 1e-2
TIME_S = STEP_S * np.arange(201)
NOISE_MM = 2e-3


def run_of(values, speed, at=1.7):
    u = sampled(STEP_S, speed, "first")
    x = at + linear_response(u, values) + gear_response(u, values, at)
    return DriveRun("a", u, x, NOISE_MM, at_rest=True)


def error_of(run, values):
    return d.DriveBench([run], None)._error(0, values)


def test_errors_count_in_units_of_noise_but_for_where_a_run_begins():
    values = DriveValues(0.02)
    run = run_of(values, 20.0 * np.sin(TIME_S))
    off = np.where(TIME_S < 1.0, 3.0, 0.0)
    wrong = DriveRun("a", run.u, run.x_in - NOISE_MM * off, NOISE_MM, at_rest=True)
    np.testing.assert_allclose(error_of(wrong, values), off - off.mean(), atol=1e-9)


@pytest.mark.parametrize("at", [0.15, -0.4, 1.7])
@pytest.mark.parametrize("kind", ["sine_mm", "cosine_mm"])
def test_the_ripple_begins_where_the_run_does(at, kind):
    """A move of a twentieth of a wave: a wave told wrongly is wrong throughout."""
    values = DriveValues(0.02, **{kind: 0.02})  # a wave is 0.6 mm long
    run = run_of(values, 2.0 * np.sin(math.pi * TIME_S), at)
    size = float(np.abs(run.x_in - run.x_in.mean()).max()) / NOISE_MM
    assert np.abs(error_of(run, values)).max() < 2e-3 * size
    other = run_of(values, 2.0 * np.sin(math.pi * TIME_S), at + 0.15)
    assert np.abs(error_of(run, values) - error_of(other, values)).max() < 4e-3 * size


def test_a_large_ripple_is_sought_from_where_the_run_is():
    """Of 0.1 mm on a move of 0.025 mm: from the opposite place a wave would still be off."""
    values = DriveValues(0.02, cosine_mm=0.1)
    run = run_of(values, 2.0 * np.sin(math.pi * TIME_S), 0.15)
    size = float(np.abs(run.x_in - run.x_in.mean()).max()) / NOISE_MM
    assert np.abs(error_of(run, values)).max() < 2e-4 * size


GAIN = 0.02
W = np.array([1.0, 2.0, 4.0, 5.0, 8.0])


def guess(terms, normal, part=1.0, w=W):
    jw = 1j * w
    return d._guess(terms, jw, GAIN * np.asarray(normal) / jw, GAIN, part)


def late_by(seconds, w=W):
    return np.array([cmath.exp(-1j * seconds * float(x)) for x in w])


def test_how_late_the_response_is_goes_to_lag_and_delay():
    late = late_by(0.03)
    late[4] *= cmath.exp(1j)  # one of five points is wrong: the median is not
    both = guess(["lag", "delay"], late)
    assert (both.motor_lag_s, both.delay_s) == pytest.approx((0.015, 0.015))
    assert guess(["lag"], late).motor_lag_s == pytest.approx(0.03)
    alone = guess(["delay", "leak"], late, 0.3)
    assert (alone.motor_lag_s, alone.delay_s) == (0.0, pytest.approx(0.009))
    early = guess(["delay"], late_by(-0.03))
    assert early.delay_s == pytest.approx(1e-4)
    assert guess(["delay"], late_by(0.03)).gain_mm_per_s_rpm == GAIN


@pytest.mark.parametrize(
    ("height", "w", "damping"),
    [
        (3.0, 5.0, 0.5 / 3.0),
        (1.21, 5.0, 0.5 / 1.21),
        (1.19, 2.0 / 0.03, 0.7),
        (0.8, 2.0 / 0.03, 0.7),
    ],
)
def test_a_spring_swings_at_a_peak_or_is_as_late_as_the_response(height, w, damping):
    """A peak is as high as 1/(2ζ); without one 2ζ/ω is about as late, with ζ of 0.7."""
    found = guess(["spring"], np.array([0.7, 1.1, 1.15, height, 1.0]) * late_by(0.03))
    assert found.natural_frequency_Hz == pytest.approx(w / (2.0 * math.pi))
    assert found.damping_ratio == pytest.approx(damping)
    assert (found.motor_lag_s, found.delay_s) == (0.0, 0.0)


def test_a_run_that_begins_in_motion_may_have_moved_already():
    """What a constant and e^(−0.8 t) make of it is no error; simulated is x_in with that left."""
    values = DriveValues(0.02, leak_per_s=0.8)
    off = np.cos(7.0 * TIME_S)
    u = sampled(STEP_S, 20.0 * np.sin(TIME_S), "first")
    free = 3.0 + 2.0 * np.exp(-0.8 * TIME_S)
    x = linear_response(u, values) + free - NOISE_MM * off
    run = DriveRun("a", u, x, NOISE_MM, at_rest=False)
    basis = np.column_stack((np.ones(TIME_S.size), np.exp(-0.8 * TIME_S)))
    left = off - basis @ np.linalg.lstsq(basis, off, rcond=None)[0]
    np.testing.assert_allclose(error_of(run, values), left, atol=1e-8)
    simulated = d.DriveBench([run], None).simulated(0, values)
    np.testing.assert_allclose(simulated, x + NOISE_MM * left, atol=1e-10)
