"""Noise level and quantisation step of a sampled channel, estimated from its samples alone."""

import math

import numpy as np

from tsas_cli.support.arrays import Floats

FEWEST_SAMPLES = 16  # for an estimate
_DIFFERENCE = np.array([1.0, -3.0, 3.0, -1.0])  # zero for a parabola
_GAIN = math.sqrt(float(np.sum(_DIFFERENCE**2)))


def noise_sd(values: Floats) -> float:
    """Return the standard deviation of the sample-to-sample noise of a channel.

    Third differences remove the motion; the noise is their trimmed mean square, without the largest
    5 % (jumps and reversals among them) and corrected for that. Slow disturbances are not counted.
    NaN for fewer than 16 samples.
    """
    clean = values[np.isfinite(values)]
    if clean.size < FEWEST_SAMPLES:
        return math.nan
    third = np.abs(np.convolve(clean, _DIFFERENCE, mode="valid"))
    trimmed = np.sort(third)[: int(0.95 * third.size)]
    return float(np.sqrt(np.mean(trimmed**2) / _TRIMMED) / _GAIN)


# Mean square of a standard normal variable whose largest 5 % in magnitude are cut off:
# 1 − 2 c φ(c)/0.95 with c = 1.95996.
_TRIMMED = 1.0 - 2.0 * 1.959964 * 0.05844507 / 0.95


def quantisation_step(values: Floats) -> float:
    """Return the step between the levels of a channel, 0 where it is not quantised.

    A channel is quantised when all differences between neighbouring levels are multiples of the
    smallest one, within a twentieth of it, and levels repeat.
    """
    levels = np.unique(values[np.isfinite(values)])
    if levels.size < 2 or levels.size > 0.5 * np.isfinite(values).sum():
        return 0.0
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * np.abs(levels).max()]  # one level may be rounded in two ways
    if gaps.size == 0:
        return 0.0
    step = float(np.median(gaps[gaps <= 1.5 * gaps.min()]))
    ratio = gaps / step
    return step if float(np.abs(ratio - np.round(ratio)).max()) < 0.05 else 0.0
