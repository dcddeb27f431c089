"""Samples laid between recorded ones are told, and recorded ones are not taken for such."""

import numpy as np
import pytest

from tsas_cli.numerics.noise import interpolated, noise_sd
from tsas_studies.challenge.rig.sensors import quantised

TIME = np.arange(400) / 100.0
MOTION = 10.0 - 10.0 * np.cos(TIME)
RNG = np.random.default_rng(1)
NOISY = quantised(MOTION + 0.02 * RNG.standard_normal(TIME.size), 0.005)


@pytest.mark.parametrize("times", [2, 3, 7, 40])
@pytest.mark.parametrize("first", [0, 1])
def test_samples_between_recorded_ones_are_told(times, first):
    at = np.arange(times * (TIME.size - 1) + 1)
    laid = np.interp(at, times * np.arange(TIME.size), NOISY)[first:]
    expected = at[first:] % times != 0
    expected[[0, -1]] = False  # an end says where the line goes to
    np.testing.assert_array_equal(interpolated(laid), expected)
    kept = np.where(interpolated(laid), np.nan, laid)
    assert noise_sd(kept) == pytest.approx(0.02, rel=0.1)
    assert noise_sd(laid) < 0.5 * 0.02  # what it would be taken for


def test_rounding_in_a_file_hides_nothing():
    at = np.arange(2 * TIME.size - 1)
    laid = np.round(np.interp(at, 2 * np.arange(TIME.size), NOISY), 4)
    assert interpolated(laid)[1:-1:2].all()


@pytest.mark.parametrize(
    "values",
    [
        NOISY,
        MOTION,
        quantised(MOTION, 0.05),  # stands still and jumps
        quantised(NOISY, 0.05),
        np.repeat(NOISY, 4),  # held, which is another thing
        np.repeat([0.0, 20.0, 20.0, 0.0, 0.0], 80),
        np.interp(TIME, [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 20.0, 0.0, 20.0, 0.0]),  # strokes
        np.full(100, 3.0),
        np.zeros(2),
        np.where(TIME > 3.9, np.nan, np.interp(TIME, TIME[::2], NOISY[::2])),  # gaps
    ],
)
def test_recorded_samples_are_not_taken_for_such(values):
    assert not interpolated(values).any()
