"""Cleaning an input: what is left of the noise, of the reversals, and in the tension."""

import numpy as np
import pytest

from tests.identification.recorded import clean
from tsas_cli.numerics.conditioning import (
    condition,
    follow_corners,
    monotone_between,
    with_turning_points,
)
from tsas_cli.numerics.local_polynomial import corners
from tsas_cli.physics.response import DriveInput, simulate
from tsas_cli.physics.rig import Rig
from tsas_studies.challenge.rig.motions import dwell, nested, sine, triangle
from tsas_studies.challenge.rig.tendon import Rig as VirtualRig

NOISE_mm = 0.005
FORCE_NOISE_N = 0.08
MODEL = Rig(0.125, VirtualRig().axial_stiffness, 1.579, 250.0 * np.pi, np.pi, 25.0)
MOTIONS = {
    "sine": sine(),
    "slow sampling": sine(rate_Hz=200.0),
    "nested": nested(rate_Hz=500.0),
    "triangle": triangle(rate_Hz=500.0),
    "dwell": dwell(rate_Hz=500.0),
}


def noisy(x, seed, sd=NOISE_mm):
    return x + np.random.default_rng(seed).normal(0.0, sd, x.size)


def cleaned(motion, seed, sd=NOISE_mm, beside=slice(None)):
    return condition(motion.time_s[beside], noisy(motion.x_in_mm[beside], seed, sd))


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("name", MOTIONS)
def test_a_true_model_stays_within_twice_the_force_noise(name):
    """Raw noise costs the model ten times the force sensor's noise and more."""
    true = clean(VirtualRig(), MOTIONS[name])
    t, x, f_in = (true.columns[c] for c in ("time_s", "x_in_mm", "f_in_N"))
    smooth = condition(t, noisy(x, seed=0)).values
    assert rms(simulate(MODEL, DriveInput(smooth)).f_in_N - f_in) < 2.0 * FORCE_NOISE_N
    if name == "sine":
        raw = simulate(MODEL, DriveInput(noisy(x, 0))).f_in_N - f_in
        assert np.std(raw) > 10.0 * FORCE_NOISE_N


@pytest.mark.parametrize("name", MOTIONS)
def test_reversals_stay_and_none_is_added(name):
    motion = MOTIONS[name]
    way = np.sign(np.diff(motion.x_in_mm))
    turns = np.flatnonzero(np.diff(way[way != 0]))
    found = cleaned(motion, 1)
    assert found.reversals.size - 2 == turns.size
    strokes = np.split(np.sign(np.diff(found.values)), found.reversals[1:-1])
    assert all(len(set(s[s != 0])) <= 1 for s in strokes)


def test_a_corner_stays_where_it_is():
    """A window of half a second across the corner would round it by 0.2 mm."""
    motion = triangle(speed_mm_s=5.0)
    apex = int(np.argmax(motion.x_in_mm))
    found = [cleaned(motion, seed) for seed in range(5)]
    heights = [c.values.max() - motion.x_in_mm[apex] for c in found]
    assert abs(np.mean(heights)) < 0.006
    assert all(abs(int(c.reversals[1]) - apex) < 12 for c in found)


@pytest.mark.parametrize("name", ["sine", "nested"])
def test_the_stated_error_is_the_error(name):
    motion = MOTIONS[name]
    each = [cleaned(motion, seed) for seed in range(4)]
    found = rms(np.concatenate([c.values - motion.x_in_mm for c in each]))
    stated = rms(np.concatenate([c.sd for c in each]))
    assert found == pytest.approx(stated, rel=0.25)
    assert found < 0.3 * NOISE_mm


@pytest.mark.parametrize(("step_mm", "least"), [(0.0, 0.6), (0.01, 0.0)])
@pytest.mark.parametrize("name", MOTIONS)
def test_cleaned_again_it_errs_as_it_does_itself(name, step_mm, least):
    """So does what a model makes of it. Of a rounded signal it is less: all errors follow it."""
    motion = MOTIONS[name]
    exact, errors = simulate(MODEL, DriveInput(motion.x_in_mm)).f_in_N, []
    for seed in range(4):
        raw = noisy(motion.x_in_mm, seed, 1e-4 if step_mm else NOISE_mm)
        found = condition(motion.time_s, step_mm * np.round(raw / step_mm) if step_mm else raw)
        drawn = found.again(motion.time_s)
        f_in, *f_drawn = (simulate(MODEL, DriveInput(x)).f_in_N for x in (found.values, *drawn))
        moved = np.array(drawn) - found.values, found.values - motion.x_in_mm
        errors.append([rms(e) for e in (*moved, np.array(f_drawn) - f_in, f_in - exact)])
    x_again, x_true, f_again, f_true = np.sqrt(np.mean(np.square(errors), axis=0))
    assert 1.3 * least * x_true <= x_again
    if step_mm == 0.0:
        assert x_again < 1.25 * x_true
    assert least * f_true <= f_again < 2.0 * f_true + 1e-5


def test_a_coarse_encoder_is_smoothed_too():
    motion = sine()
    coarse = np.round(motion.x_in_mm / 0.01) * 0.01
    found = condition(motion.time_s, coarse)
    assert found.noise == pytest.approx(0.01 / np.sqrt(12.0), rel=0.2)
    assert rms(found.values - motion.x_in_mm) < 0.5 * rms(coarse - motion.x_in_mm)
    assert found.reversals.size == 5


def test_a_rest_is_flat():
    motion = dwell()
    still = np.abs(np.diff(motion.x_in_mm, prepend=0.0)) < 1e-12
    resting = np.convolve(still, np.ones(201), "same") > 200
    assert resting.sum() > 500
    steps = np.abs(np.diff(cleaned(motion, 3).values))
    assert steps[resting[1:] & resting[:-1]].max() < 1e-12


def slowed(time_s, rest_s=0.5, brake_s=0.1, speed=10.0):
    """Return strokes of 10 mm that begin and end with a constant acceleration, and rest between."""
    phase = time_s % (4.0 * (1.0 + rest_s))
    v = np.zeros(time_s.size)
    for k, sign in enumerate((1.0, 1.0, -1.0, -1.0)):
        since = phase - k * (1.0 + rest_s)
        ramp = np.minimum(since, 1.0 - since) / brake_s
        v += sign * speed * np.clip(ramp, 0.0, 1.0) * (since < 1.0)
    return np.cumsum(v) * (time_s[1] - time_s[0]), v


@pytest.mark.parametrize("sd", [1e-3, 5e-3])
def test_a_rest_that_a_motion_ends_in_without_a_corner_is_flat(sd):
    t = np.arange(0.0, 12.0, 0.004)
    x, v = slowed(t)
    smooth = condition(t, noisy(x, seed=5, sd=sd)).values
    middle = np.convolve(v == 0.0, np.ones(76), "same") > 75.5  # 0.15 s from the motion on
    assert middle.sum() > 300
    assert np.abs(np.diff(smooth))[middle[1:] & middle[:-1]].max() < 1e-12
    assert np.abs(smooth - x)[middle].max() < sd


@pytest.mark.parametrize("seed", range(6))
def test_a_long_rest_within_counts_of_an_encoder_is_one_rest(seed):
    """Corners of its noise cut it; between parts of unlike means the tendon would turn."""
    t = np.arange(0.0, 40.0, 0.01)
    x, v = slowed(t, rest_s=4.0, brake_s=0.2, speed=18.0)
    counted = np.round(noisy(x, seed=seed, sd=5e-3) / 0.01) * 0.01
    smooth = condition(t, counted).values
    middle = np.convolve(v == 0.0, np.ones(101), "same") > 100.5  # 0.5 s from the motion on
    assert middle.sum() > 2000
    assert np.abs(np.diff(smooth))[middle[1:] & middle[:-1]].max() < 1e-12
    ended = (v[:-1] != 0.0) & (v[1:] == 0.0)
    for stop in np.flatnonzero(ended)[:-1] + 1:  # no overshoot before a rest
        rest, way = smooth[stop + 200], np.sign(v[stop - 10])
        assert ((smooth[stop - 20 : stop + 200] - rest) * way).max() < 1e-9


@pytest.mark.parametrize("creeping_mm_per_s", [0.02, 0.1])
def test_a_creeping_motion_is_no_rest(creeping_mm_per_s):
    t = np.arange(0.0, 20.0, 0.004)
    x = creeping_mm_per_s * t
    smooth = condition(t, noisy(x, seed=6, sd=1e-3)).values
    assert np.abs(smooth - x).max() < 2e-3


def test_without_noise_nothing_changes():
    motion = sine()
    assert np.abs(cleaned(motion, 0, sd=0.0).values - motion.x_in_mm).max() < 1e-6


@pytest.mark.parametrize("vibration_Hz", [60.0, 100.0])
def test_a_vibration_above_the_noise_is_no_corner(vibration_Hz):
    """Of a motion of 150 mm/s a vibration of 1 µm, 200 times the noise, may be lost at most."""
    t = 1e-3 * np.arange(8000)
    x = 50.0 - 50.0 * np.cos(np.pi * t) + 1e-3 * np.sin(2.0 * np.pi * vibration_Hz * t)
    assert np.abs(condition(t, noisy(x, 1, sd=5e-6)).values - x).max() < 1e-3


def test_a_gap_is_bridged_by_a_straight_line():
    motion = triangle()
    x = noisy(motion.x_in_mm, 4)
    x[1000:1100] = np.nan
    found = condition(motion.time_s, x).values
    assert np.isfinite(found).all()
    assert rms((found - motion.x_in_mm)[1000:1100]) < NOISE_mm


def test_irregular_times_do_as_well():
    rng = np.random.default_rng(5)
    t = np.sort(rng.uniform(0.0, 4.0 * np.pi, 6000))
    x = 10.0 - 10.0 * np.cos(t)
    found = condition(t, noisy(x, 6))
    assert rms(found.values - x) < 0.3 * NOISE_mm
    assert found.reversals.size == 5


def test_scaling_scales():
    """Another unit gives the same signal, window and reversals."""
    motion = nested()
    x = noisy(motion.x_in_mm, 7)
    one, other = condition(motion.time_s, x), condition(motion.time_s, x / 25.4)
    assert np.allclose(one.values, 25.4 * other.values, atol=1e-9)
    assert one.window_s == other.window_s
    assert np.array_equal(one.reversals, other.reversals)


def test_monotone_between_turns_only():
    values = np.array([0.0, 2.0, 1.0, 3.0, 2.5, 2.6, 1.0])
    assert monotone_between(values, np.array([0, 3, 6])) == pytest.approx(
        [0.0, 1.5, 1.5, 3.0, 2.55, 2.55, 1.0]
    )


def test_a_corner_does_not_stick_out():
    """A cut one sample off the corner must not leave a peak of twice the step."""
    motion = triangle(speed_mm_s=10.0)
    apex = int(np.argmax(motion.x_in_mm))
    step = motion.x_in_mm[apex] - motion.x_in_mm[apex - 1]
    beside = slice(apex - 500, apex + 500)
    for seed in range(20):
        highest = cleaned(motion, seed, 0.01, beside).values.max()
        assert highest - motion.x_in_mm[apex] < 0.5 * step


def test_a_fast_turn_that_few_samples_show_is_no_corner_and_a_corner_is():
    """Of 33 samples a period parabolas to both sides differ in slope by 18 deviations."""
    t = np.arange(0.0, 30.0, 0.02)
    phase = 9.6 * t
    sine_mm, triangle_mm = 13.0 * np.sin(phase), 13.0 * np.arcsin(np.sin(phase))
    assert corners(t, noisy(sine_mm, 1), 4, NOISE_mm).tolist() == [0, t.size]
    assert corners(t, noisy(triangle_mm, 1), 4, NOISE_mm).size > 80


def test_stamps_of_a_busy_computer_stop_no_search_for_corners():
    """Each is late by up to 0.1 s, so that many follow within 5 µs: a window holds few moments."""
    rng = np.random.default_rng(0)
    late = np.arange(0.0, 20.0, 0.005) + 0.03 * np.abs(rng.standard_normal(4000))
    t = np.round(np.maximum.accumulate(late) + 5e-6 * np.arange(late.size), 9)
    found = corners(t, noisy(13.0 * np.arcsin(np.sin(1.6 * t)), 1), 4, NOISE_mm)
    assert (found[0], found[-1]) == (0, t.size)


@pytest.mark.parametrize("rate_Hz", [25.0, 50.0, 100.0])
def test_a_motion_that_turns_between_two_samples_turns_where_it_does(rate_Hz):
    """The samples miss the turn by up to 48, 10 and 3 µm: nothing to a smooth model."""
    t = np.arange(0.0, 30.0, 1.0 / rate_Hz)
    found = condition(t, noisy(13.0 * np.sin(2.0 * np.pi * 0.7 * t + 0.3), 2, sd=0.002))
    turns = found.values[found.reversals[1:-1]]
    assert np.abs(np.abs(turns) - 13.0).max() < 0.005


def test_what_turns_at_a_corner_or_after_a_rest_turns_at_its_sample():
    for values in ([0.0, 1.0, 2.0, 1.6, 0.6, -0.4], [0.0, 1.0, 1.0, 1.0, 0.5, 0.0]):
        given = np.array(values)
        reversals = np.array([0, int(np.argmax(given[::-1] == given.max())), 5])
        assert with_turning_points(given, reversals).tolist() == values
    parabola = 1.0 - (np.arange(6.0) - 2.4) ** 2
    assert with_turning_points(parabola, np.array([0, 2, 5]))[2] == pytest.approx(1.0)


@pytest.mark.parametrize(("rad_per_s", "turn_ms"), [(3.2, 81), (2.4, 101), (3.2, 121)])
def test_a_rounded_corner_of_few_samples_is_followed(rad_per_s, turn_ms):
    """A fit of fourth degree misses samples there by 10 to 20 deviations."""
    fine = np.arange(0.0, 30.0, 0.001)
    triangle_mm = 6.5 * np.arcsin(np.sin(rad_per_s * fine))
    mean_of = np.full(turn_ms, 1.0 / turn_ms)
    rounded_mm = np.convolve(np.pad(triangle_mm, turn_ms // 2, mode="edge"), mean_of, "valid")
    t, true_mm = fine[::20], rounded_mm[::20]
    for seed in range(5):
        missed = np.abs(condition(t, noisy(true_mm, seed, sd=0.005)).values - true_mm)
        assert missed.max() < 8.0 * 0.005


def test_what_rings_is_left_to_the_fit():
    values, noise = np.linspace(0.0, 6.0, 60), 0.01
    values[20:32] += np.resize([0.3, -0.3], 12)
    values[45:] += 0.2
    smooth, half = np.linspace(0.0, 6.0, 60), np.full(60, 4)
    follow_corners(values, smooth, np.full(60, noise), half, noise)
    assert np.all(smooth[22:30] == np.linspace(0.0, 6.0, 60)[22:30])
    assert np.all(smooth[45:] == values[45:])
