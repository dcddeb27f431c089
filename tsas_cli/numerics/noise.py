"""Noise, quantisation and interpolation of a channel, estimated from its samples alone."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats, Indices, Mask

FEWEST_SAMPLES = 16  # for an estimate
STRIDES = (2, 4)  # samples, by which third differences show whether noise has a memory
CERTAIN = 4.0  # standard deviations by which they have to differ
SCATTER = 2.8  # standard deviation of the logarithm of a ratio of two mean squares, times √n
MOST_GROWN = 2.1  # of one ratio: a random walk has 2, a vibration and motion have more
FASTER = 1.2  # growth of the second ratio over that of the first, in logarithms; a motion has 1.6
UNEVEN = 1e-3  # of the interval: the scatter of times that are not those of an even clock
CORRELATIONS = np.linspace(0.0, 0.9, 901)  # of neighbouring samples


class Noise(NamedTuple):
    """Noise of a channel: its standard deviation, and the correlation of neighbouring samples.

    That of samples k apart is its k-th power, as behind a first-order low pass. `step` is that of
    the channel's quantisation, which is a part of its noise.
    """

    sd: float
    correlation: float = 0.0
    step: float = 0.0

    def growth(self, count: Floats | Indices) -> Floats:
        """Return the variance of a mean of so many samples, over that of white noise."""
        c = self.correlation
        return np.asarray(
            (1.0 + c) / (1.0 - c) - 2.0 * c * (1.0 - c**count) / (1.0 - c) ** 2 / count
        )


def noise_of(values: Floats, time_s: Floats | None = None) -> Noise:
    """Return the noise of a channel, with quantisation; NaN for too few samples.

    Third differences of every second and fourth sample have the mean square of those of all where
    the noise is white, and a larger one where it has a memory; motion adds to them too, by four
    times as much or more at each step. So noise has a memory where they grow less from step to
    step, within chance; how long follows from the first one (or from both where it is less), by an
    autoregressive process of first order. A vibration over a few samples counts as such noise.
    The times are those at which the samples were taken, or rounded ones of an even clock, as
    without any: of the two noises the smaller one.
    """
    step = quantisation_step(values)
    found = [_noise_of(clean, at, step) for clean, at in _at_times(values, time_s)]
    return min(found, key=lambda noise: noise.sd)


def _noise_of(clean: Floats, time_s: Floats | None, step: float) -> Noise:
    white = _noise_sd(clean, time_s)
    rounding = step / math.sqrt(12.0)
    if not white > rounding:
        return Noise(rounding if white <= rounding else math.nan, step=step)
    first = white**2
    second, last = (_third_square(clean, time_s, stride) for stride in STRIDES)
    certain = math.exp(CERTAIN * SCATTER / math.sqrt(clean.size))
    grown = second / first
    if not certain < grown < MOST_GROWN or last / second > grown**FASTER:
        return Noise(white, step=step)
    correlation = min(
        float(np.interp(square / first, shares / _SHARES[0], CORRELATIONS))
        for square, shares in zip((second, last), _SHARES[1:], strict=True)
    )
    share = float(np.interp(correlation, CORRELATIONS, _SHARES[0]))
    return Noise(white / math.sqrt(share), correlation, step)


def noise_sd(values: Floats, time_s: Floats | None = None) -> float:
    """Return the standard deviation of the sample-to-sample noise of a channel.

    Third differences remove the motion; the noise is their trimmed mean square, without the largest
    5 % (jumps and reversals among them) and corrected for that. Slow disturbances are not counted.
    NaN for fewer than 16 samples.
    """
    return min(_noise_sd(*clean) for clean in _at_times(values, time_s))


def _noise_sd(clean: Floats, time_s: Floats | None) -> float:
    return math.nan if clean.size < FEWEST_SAMPLES else math.sqrt(_third_square(clean, time_s, 1))


def _at_times(values: Floats, time_s: Floats | None) -> list[tuple[Floats, Floats | None]]:
    """Return the finite values at even times (None), and at the given ones where these are uneven.

    Times that do not increase are none at which samples were taken.
    """
    finite = np.isfinite(values)
    clean = values[finite]
    if time_s is None:
        return [(clean, None)]
    interval = np.diff(time_s[finite])
    uneven = interval.size > 0 and interval.min() > 0.0 and np.ptp(interval) > UNEVEN * interval[0]
    return [(clean, None), *([(clean, time_s[finite])] if uneven else [])]


def _third_square(values: Floats, time_s: Floats | None, stride: int) -> float:
    """Return the mean square of third differences of one in `stride` samples.

    Trimmed and corrected, and over that of white noise of variance one; infinite for too few.
    """
    third = np.abs(third_differences(values, time_s, stride))
    third = np.sort(third)[: int(0.95 * third.size)]
    return float(np.mean(third**2)) / _TRIMMED if third.size else math.inf


def third_differences(values: Floats, time_s: Floats | None = None, stride: int = 1) -> Floats:
    """Return the third differences of one in `stride` samples, by times, or even ones if None.

    They are zero for a parabola, and of variance one for white noise of variance one.
    """
    four = [slice(k * stride, max(values.size - (3 - k) * stride, 0)) for k in range(4)]
    a, b, c, d = (values[part] for part in four)
    if time_s is None:
        return np.asarray((a - 3.0 * b + 3.0 * c - d) / math.sqrt(20.0))
    third, square = np.zeros(a.size), np.zeros(a.size)
    for part in four:
        others = [time_s[part] - time_s[other] for other in four if other is not part]
        weight = 1.0 / (others[0] * others[1] * others[2])
        third += weight * values[part]
        square += weight**2
    return np.asarray(third / np.sqrt(square))


def _share(correlation: Floats) -> Floats:
    """Return the mean square of third differences of noise of that correlation, over its own."""
    return 1.0 - 1.5 * correlation + 0.6 * correlation**2 - 0.1 * correlation**3


_SHARES = np.array([_share(CORRELATIONS**stride) for stride in (1, *STRIDES)])


@kernel
def with_memory(white: Floats, correlation: float) -> Floats:
    """Return noise of a correlation of neighbouring samples, made of white noise as large."""
    out, fresh = white.copy(), math.sqrt(1.0 - correlation**2)
    for i in range(1, white.size):
        out[i] = correlation * out[i - 1] + fresh * white[i]
    return out


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


def recorded(values: Floats) -> Floats:
    """Return a channel with NaN in place of interpolated samples, which carry no information."""
    return np.where(interpolated(values), math.nan, values)
