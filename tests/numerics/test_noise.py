import math

import numpy as np
import pytest
from scipy.signal import lfilter

from tsas_cli.numerics.noise import Noise, noise_of, noise_sd, quantisation_step, with_memory

TIME_S = np.arange(20_000) / 1000
SINE = 10 * np.sin(2 * np.pi * 0.5 * TIME_S)
JUMPS = 40 * np.abs((TIME_S / 2) % 1 - 0.5) + np.where((TIME_S % 4) < 2, 0.0, 30.0)


def noisy(sd, seed=0, motion=SINE):
    return motion + sd * np.random.default_rng(seed).standard_normal(SINE.size)


@pytest.mark.parametrize("motion", [SINE, JUMPS], ids=["sine", "jumps and reversals"])
@pytest.mark.parametrize("sd", [0.005, 0.1, 2.0])
@pytest.mark.parametrize("seed", range(3))
def test_white_noise_on_a_motion_is_recovered(sd, seed, motion):
    values = noisy(sd, seed, motion)
    assert noise_sd(values) == pytest.approx(sd, rel=0.05)
    assert noise_sd(1000.0 - 3 * values) == pytest.approx(3 * noise_sd(values), rel=1e-6)
    values[500:700] = values[3000] = np.nan
    assert noise_sd(values) == pytest.approx(sd, rel=0.05)


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_noise_of_samples_at_uneven_times_is_that_beside_the_motion_of_then(correlation):
    """Of a log by a busy computer; without the times half a sample of the motion is noise too."""
    rng = np.random.default_rng(2)
    time_s = TIME_S + 2e-4 * rng.standard_normal(TIME_S.size).clip(-2.0, 2.0)
    noise = 0.003 * with_memory(rng.standard_normal(TIME_S.size), correlation)
    values = 10.0 * np.sin(np.pi * time_s) + noise
    found = noise_of(values, time_s)
    assert found.sd == pytest.approx(0.003, rel=0.05)
    assert found.correlation == pytest.approx(correlation, abs=0.05)
    assert noise_sd(values, time_s) == pytest.approx(noise_sd(noise), rel=0.05)
    assert noise_sd(values) > 1.5 * noise_sd(values, time_s)


@pytest.mark.parametrize("written_s", [np.round(TIME_S / 3e-4) * 3e-4, np.floor(TIME_S)])
def test_times_that_are_rounded_or_repeat_hide_no_even_clock(written_s):
    assert noise_of(noisy(0.005), written_s) == noise_of(noisy(0.005))


def test_the_motion_itself_is_not_noise():
    assert noise_sd(SINE) < 1e-5


def test_one_percent_of_wild_samples_does_not_count():
    values = noisy(0.1)
    values[::100] += 50.0
    assert noise_sd(values) == pytest.approx(0.1, rel=0.15)
    assert np.std(np.diff(values)) > 5.0  # a plain formula is off by far


def test_too_few_samples_give_no_answer():
    assert np.isnan(noise_sd(np.full(1000, np.nan)))
    assert np.isnan(noise_sd(SINE[:15]))
    assert np.isfinite(noise_sd(SINE[:16]))


def filtered(sd, correlation, seed=0, size=SINE.size):
    """Return noise behind a digital low pass, of a standard deviation, after it has settled."""
    kick = np.sqrt(1.0 - correlation**2) * np.random.default_rng(seed).standard_normal(size + 200)
    return sd * lfilter([1.0], [1.0, -correlation], kick)[200:]


@pytest.mark.parametrize("motion", [0.0 * SINE, SINE, JUMPS], ids=["none", "sine", "jumps"])
@pytest.mark.parametrize(("correlation", "error"), [(0.3, 0.05), (0.55, 0.08), (0.8, 0.2)])
def test_noise_behind_a_low_pass_is_recovered_with_its_memory(motion, correlation, error):
    """From sample to sample it changes by far less than it is, the longer its memory the less."""
    values = motion + filtered(0.2, correlation)
    found = noise_of(values)
    assert found.sd == pytest.approx(0.2, rel=error)
    assert found.correlation == pytest.approx(correlation, abs=0.1)
    if correlation > 0.5:
        assert noise_sd(values) < 0.65 * found.sd


@pytest.mark.parametrize("motion", [SINE, JUMPS, 0.01 * SINE**2], ids=["sine", "jumps", "small"])
@pytest.mark.parametrize("coarse", [1, 5, 10, 20, 40])
@pytest.mark.parametrize("sd", [0.005, 0.05])
def test_a_motion_at_any_rate_is_no_memory(motion, coarse, sd):
    """Sampled coarsely, third differences of a motion rise above white noise, ever faster."""
    for seed in range(5):
        values = noisy(sd, seed, motion)[::coarse]
        assert noise_of(values) == Noise(noise_sd(values), 0.0)


@pytest.mark.parametrize("period", [2, 4, 8])
def test_what_repeats_after_a_few_samples_has_no_memory(period):
    """Third differences of every second or fourth sample vanish, or are those of rounding."""
    values = np.tile(np.random.default_rng(1).standard_normal(period), 100)
    assert noise_of(values).correlation == 0.0
    assert noise_of(np.tile([0.0, 1.0], 100)).correlation == 0.0


def test_a_mean_of_noise_with_a_memory_is_as_uncertain_as_it_says():
    """The variance of means of c samples, over that of one sample divided by c."""
    for correlation in (0.0, 0.5, 0.9):
        noise = filtered(1.0, correlation, size=2_000_000)
        for count in (1, 2, 10, 100):
            means = noise.reshape(-1, count).mean(axis=1)
            expected = count * np.var(means)
            assert Noise(1.0, correlation).growth(np.array(count)) == pytest.approx(
                expected, rel=0.05
            )


def test_white_noise_gets_a_memory():
    white = np.random.default_rng(2).standard_normal(200_000)
    made = with_memory(white, 0.6)
    assert np.std(made) == pytest.approx(1.0, rel=0.02)
    assert np.corrcoef(made[1:], made[:-1])[0, 1] == pytest.approx(0.6, abs=0.01)
    np.testing.assert_array_equal(with_memory(white, 0.0), white)


def test_noise_is_at_least_that_of_quantisation():
    """A step of 0.5 has a standard deviation of 0.5/√12."""
    steps = 0.5 * np.repeat(np.arange(10.0), 20)
    assert noise_of(steps).sd == pytest.approx(0.5 / math.sqrt(12.0))
    assert math.isnan(noise_of(np.arange(5.0)).sd)
    assert noise_of(np.full(100, 3.0)).sd == 0.0
    white = np.random.default_rng(1).standard_normal(10_000)
    assert noise_of(white).sd == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("step", [0.002, 0.1, 20 / 4096])
@pytest.mark.parametrize("offset", [0.0, 1234.5])
def test_the_step_of_a_coarse_channel_is_found(step, offset):
    coarse = offset + step * np.round(noisy(2 * step) / step)
    assert quantisation_step(coarse) == pytest.approx(step, rel=1e-6)


def test_a_level_that_is_rounded_in_two_ways_does_not_hide_the_step():
    values = np.tile(np.array([0.1 + 0.2, 0.3, 0.4, 0.5]), 30)
    assert quantisation_step(values) == pytest.approx(0.1)


@pytest.mark.parametrize(
    "values",
    [
        noisy(0.1),
        *([], [1.0], [2.0] * 50, [np.nan] * 50),  # it does not move
        [0.0, 1.0, 2.37, 4.1, 5.9] * 30,  # levels that are no multiples
    ],
)
def test_other_channels_have_no_step(values):
    assert quantisation_step(np.array(values)) == 0.0
