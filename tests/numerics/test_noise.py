import numpy as np
import pytest

from tsas_cli.numerics.noise import noise_sd, quantisation_step

TIME_S = np.arange(20_000) / 1000
SINE = 10 * np.sin(2 * np.pi * 0.5 * TIME_S)


def noisy(sd: float, seed: int = 0) -> np.ndarray:
    return SINE + sd * np.random.default_rng(seed).standard_normal(SINE.size)


@pytest.mark.parametrize("sd", [0.005, 0.1, 2.0])
@pytest.mark.parametrize("seed", range(3))
def test_white_noise_on_a_motion_is_recovered(sd: float, seed: int) -> None:
    assert noise_sd(noisy(sd, seed)) == pytest.approx(sd, rel=0.05)


def test_the_motion_itself_is_not_noise() -> None:
    assert noise_sd(SINE) < 1e-5


def test_one_percent_of_wild_samples_does_not_count() -> None:
    values = noisy(0.1)
    values[::100] += 50.0
    assert noise_sd(values) == pytest.approx(0.1, rel=0.15)
    assert np.std(np.diff(values)) > 5.0  # a plain formula is off by far


def test_jumps_and_reversals_do_not_count() -> None:
    triangle = 40 * np.abs((TIME_S / 2) % 1 - 0.5)
    steps = np.where((TIME_S % 4) < 2, 0.0, 30.0)
    noise = noisy(0.1) - SINE
    assert noise_sd(triangle + steps + noise) == pytest.approx(0.1, rel=0.05)


def test_gaps_are_left_out() -> None:
    values = noisy(0.1)
    values[500:700] = np.nan
    values[3000] = np.nan
    assert noise_sd(values) == pytest.approx(0.1, rel=0.05)


def test_offset_and_gain_act_as_they_must() -> None:
    values = noisy(0.1)
    assert noise_sd(1000.0 - 3 * values) == pytest.approx(3 * noise_sd(values), rel=1e-6)


def test_too_few_samples_give_no_answer() -> None:
    assert np.isnan(noise_sd(np.full(1000, np.nan)))
    assert np.isnan(noise_sd(SINE[:15]))
    assert np.isfinite(noise_sd(SINE[:16]))


@pytest.mark.parametrize("step", [0.002, 0.1, 20 / 4096])
@pytest.mark.parametrize("offset", [0.0, 1234.5])
def test_the_step_of_a_coarse_channel_is_found(step: float, offset: float) -> None:
    coarse = offset + step * np.round(noisy(2 * step) / step)
    assert quantisation_step(coarse) == pytest.approx(step, rel=1e-6)


def test_a_fine_channel_has_no_step() -> None:
    assert quantisation_step(noisy(0.1)) == 0.0


@pytest.mark.parametrize("values", [[], [1.0], [2.0] * 50, [np.nan] * 50])
def test_a_channel_that_does_not_move_has_no_step(values: list[float]) -> None:
    assert quantisation_step(np.array(values)) == 0.0


def test_levels_that_are_no_multiples_are_no_quantisation() -> None:
    levels = np.array([0.0, 1.0, 2.37, 4.1, 5.9])
    assert quantisation_step(np.tile(levels, 30)) == 0.0


def test_a_level_that_is_rounded_in_two_ways_does_not_hide_the_step() -> None:
    values = np.tile(np.array([0.1 + 0.2, 0.3, 0.4, 0.5]), 30)
    assert quantisation_step(values) == pytest.approx(0.1)
