"""Noise, quantisation and interpolation of a channel, estimated from its samples alone."""

import math

import numpy as np

from tsas_cli.support.arrays import Floats, Mask

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


MOST_RATIO = 50  # of the clock's rate to that of the recorded samples
STRAIGHT = 0.03  # second difference, over its RMS, that rounding in a file may leave
KINKED = 0.5  # share of the recorded samples that have to be off the line of their neighbours
FEWEST = 16  # recorded samples, so that it is not chance


def interpolated(values: Floats) -> Mask:
    """Return which samples are interpolated, shape (n,); none where that is uncertain.

    The channel has to be straight except at every second, third … sample of an even clock.
    Resampling a slow channel onto a faster clock does that, as `tsas ingest` with `resample`. Such
    samples have no noise of their own: counted in, a channel seems four times less noisy than it
    is, and its residual several times the noise level that it is.
    """
    none = np.zeros(values.size, dtype=np.bool_)
    if values.size < 3 or not np.isfinite(values).all():
        return none
    bend = np.abs(np.diff(values, 2))
    kinks = np.flatnonzero(bend > STRAIGHT * np.sqrt(np.mean(bend**2))) + 1
    if kinks.size < KINKED * FEWEST:
        return none
    ratio = int(np.gcd.reduce(np.diff(kinks)))
    recorded = np.arange(kinks[0] % ratio, values.size, ratio)
    if not 1 < ratio <= MOST_RATIO or kinks.size < KINKED * max(recorded.size, FEWEST):
        return none
    between = ~none
    between[recorded] = False
    between[[0, -1]] = False  # no recorded sample bounds them
    return between
