import numpy as np
import pytest

from tsas_cli.numerics.noise import noise_sd, quantisation_step

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
