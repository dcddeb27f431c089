"""Motions sample by sample: where strokes end, how long they take, how corners are rounded."""

import math

import numpy as np
import pytest

from tsas_cli.diagnosis.motions import motion

KINDS = ("sine", "ramps", "steps", "nested", "chirp")


A, V, RATE = 7.0, 5.0, 500.0


def moved(kind, *, periods=1, dwell_s=0.0, amplitude=A, speed=V, rate=RATE):
    return motion(
        kind,
        amplitude_mm=amplitude,
        speed_mm_per_s=speed,
        periods=periods,
        dwell_s=dwell_s,
        rate_Hz=rate,
    )


@pytest.mark.parametrize("kind", KINDS)
def test_the_stroke_is_twice_the_amplitude_and_the_speed_is_reached(kind):
    _, x = moved(kind, periods=2)
    assert x[0] == pytest.approx(0.0, abs=0.1)
    assert x[-1] == pytest.approx(0.0, abs=0.1)
    assert (x.min(), x.max()) == pytest.approx((0.0, 14.0), abs=0.2)
    assert np.abs(np.diff(x)).max() * 500.0 == pytest.approx(5.0, rel=0.08)


def test_a_sine_is_the_formula():
    t, x = moved("sine", periods=2)
    assert x == pytest.approx(7.0 * (1.0 - np.cos(5.0 / 7.0 * t)), abs=1e-9)
    assert t[-1] == pytest.approx(2 * 2.0 * math.pi * 7.0 / 5.0, abs=0.002)


def turning_points(x):
    way = np.sign(np.diff(x))
    turns = 1 + np.flatnonzero(way[1:] * way[:-1] < 0.0)
    return x[turns]


def test_nested_loops_turn_where_they_should():
    _, x = moved("nested", periods=2)
    loop = [14.0, 4.2, 9.8, 5.6, 14.0]
    assert turning_points(x) == pytest.approx([*loop, 0.0, *loop], abs=1e-3)
    assert x[-1] == pytest.approx(0.0, abs=1e-3)


def test_a_nested_stroke_is_half_a_cosine_at_the_highest_speed():
    """The way from 14 to 4.2 mm takes π/2 · 9.8/5 s, after the π/2 · 14/5 s of the first one."""
    t, x = moved("nested")
    begins, lasts = 0.5 * math.pi * 14.0 / V, 0.5 * math.pi * 9.8 / V
    within = (t >= begins) & (t <= begins + lasts)
    share = (t[within] - begins) / lasts
    assert x[within] == pytest.approx(9.1 + 4.9 * np.cos(math.pi * share), abs=1e-9)
    ways = [14.0, 9.8, 5.6, 4.2, 8.4, 14.0]
    assert t[-1] == pytest.approx(0.5 * math.pi * sum(ways) / V, abs=1.0 / RATE)


def test_a_staircase_goes_up_and_down_by_quarters():
    """A step of 3.5 mm takes 0.7 s, the rest after it 2 s: looked at in the middle of each rest."""
    t, x = moved("steps", periods=2, dwell_s=2.0)
    levels = [3.5, 7.0, 10.5, 14.0, 10.5, 7.0, 3.5, 0.0]
    middles = 0.7 + 1.0 + 2.7 * np.arange(16)
    assert np.interp(middles, t, x) == pytest.approx(levels * 2)
    assert t[-1] == pytest.approx(16 * 2.7)


def test_the_last_stroke_has_its_rest_too():
    t, x = moved("sine", dwell_s=1.5)
    stroke = math.pi * A / V
    assert t[-1] == pytest.approx(2.0 * (stroke + 1.5), abs=1.0 / RATE)
    up = (t > stroke) & (t < stroke + 1.5)
    assert x[up] == pytest.approx(14.0)
    assert x[t > 2.0 * stroke + 1.5] == pytest.approx(0.0)


def test_the_corner_of_a_ramp_is_the_mean_over_a_tenth_of_a_second():
    """25 samples before and after each one, 5/500 mm apart; the ends are held."""
    t, x = moved("ramps")
    away = 0.01 * sum(abs(k) for k in range(-25, 26)) / 51
    assert x[1400] == pytest.approx(14.0 - away)
    assert x[0] == pytest.approx(0.5 * away)
    assert x[-1] == pytest.approx(0.5 * away)
    assert x[25:1375] == pytest.approx(V * t[25:1375])
    assert x[1376] < V * t[1376] - 1e-6


def test_a_chirp_is_a_sine_of_the_integral_of_its_frequency():
    t, x = moved("chirp", periods=3)
    highest = V / (2.0 * math.pi * A)
    end = 3.0 / (0.55 * highest)
    assert t[-1] == pytest.approx(end, abs=1.0 / RATE)
    frequency = highest * (0.1 + 0.9 * t / end)
    cycles = np.concatenate(([0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1]) / RATE)))
    assert x == pytest.approx(A * (1.0 - np.cos(2.0 * math.pi * cycles)), abs=1e-6)


def test_time_begins_at_0_and_no_sample_is_lost_to_rounding():
    """2 · 2.175 s at 100 Hz: 434.99999999999994 in floating point, 436 samples."""
    assert 4.35 * 100.0 < 435.0
    t, _ = moved("ramps", amplitude=1.0875, speed=1.0, rate=100.0)
    np.testing.assert_allclose(t, np.arange(436) / 100.0)
