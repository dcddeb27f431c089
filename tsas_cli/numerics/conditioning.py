"""Clean a measured input before it drives a hysteretic model, and say how.

Raw noise would turn into reversals, each of which meets the infinite stiffness of a turning
point. Three steps, none of which delays the signal:

1. Corners: where the slopes of quadratic fits to the past and to the future differ by far more
   than their noise, the signal is cut, so that sharp reversals and the ends of dwells stay sharp.
2. Between corners local quadratic fits. The window is the one with the least estimated risk
   (Stein's unbiased estimate), chosen anew along the signal: wide where the motion is smooth. A
   piece that does not move is its mean.
3. Between the reversals that stand out of the remaining noise, the nearest monotone signal in the
   least-squares sense (pool adjacent violators): no spurious reversal is left.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.noise import noise_sd, quantisation_step
from tsas_cli.numerics.turning_points import turning_points

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

METHOD = "local quadratic between corners, window of least risk; monotone between reversals"
HALF_WINDOWS = np.array([3, 5, 8, 12, 18, 27, 40, 60, 90, 135, 200, 300, 450])  # samples
RISK_POINTS = 2000  # where the risk is looked at, evenly spread
RISK_BLOCKS = 40  # pieces of the signal that may have windows of their own
UNDERSMOOTH = 0.75  # of the window of least risk: what follows minds bias more than noise
CORNER = 6.0  # standard deviations of the difference of two slopes
MOVES = 4.0  # standard deviations by which a piece that moves departs from its mean
STANDS_OUT = 8.0  # standard deviations by which a reversal turns back


@dataclass(frozen=True)
class Conditioned:
    """A cleaned signal, shape (n,), in the unit of the raw one.

    `sd` is the standard deviation of its error per sample, `window_s` the median window,
    `noise` the raw noise, `reversals` the indices of the extrema that were kept, with both ends.
    """

    values: Floats
    sd: Floats
    window_s: float
    noise: float
    reversals: Indices


def condition(time_s: Floats, values: Floats) -> Conditioned:
    """Clean a signal sampled at any increasing times.

    Parameters
    ----------
    time_s, values
        Times and the signal, shape (n,); NaN in the signal is a gap, filled by a straight line.
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < values.size:
        return _with_gaps(condition(time_s[there], values[there]), time_s, there)
    step = quantisation_step(values)
    noise = max(noise_sd(values), step / math.sqrt(12.0))
    if not noise > 0.0:  # noise-free, or too short to tell
        return Conditioned(values, np.zeros(values.size), 0.0, 0.0, turning_points(values, 0.0))
    memory = _plateau(values) if step > 0.0 else 1.0
    whole = np.array([0, values.size], dtype=np.int64)
    # Corners spoil the blocks that they lie in; the smooth blocks tell the window to seek them by.
    alone = best_half_windows(time_s, values, whole, noise, memory, pooled=1)
    cuts = corners(time_s, values, int(np.percentile(alone, 75)), noise * math.sqrt(memory))
    half = best_half_windows(time_s, values, cuts, noise, memory, pooled=5)
    smooth, sd = smoothed(time_s, values, cuts, half, noise * math.sqrt(memory))
    lay_flat(time_s, values, smooth, sd, cuts, int(np.median(half)), noise * math.sqrt(memory))
    reversals = turning_points(smooth, STANDS_OUT * float(np.median(sd)))
    window_s = float(np.median(2 * half + 1) * np.median(np.diff(time_s)))
    return Conditioned(monotone_between(smooth, reversals), sd, window_s, noise, reversals)


def _with_gaps(cleaned: Conditioned, time_s: Floats, there: Indices) -> Conditioned:
    """Lay a signal that was cleaned at some samples over all of them, straight in between."""
    reversals = there[cleaned.reversals]
    reversals[0], reversals[-1] = 0, time_s.size - 1
    return replace(
        cleaned,
        values=np.interp(time_s, time_s[there], cleaned.values),
        sd=np.interp(time_s, time_s[there], cleaned.sd),
        reversals=reversals,
    )


def _plateau(values: Floats) -> float:
    """Return the mean number of samples that a quantised signal stays at one level."""
    return values.size / (1.0 + np.count_nonzero(np.diff(values)))


def best_half_windows(
    time_s: Floats, values: Floats, cuts: Indices, noise: float, memory: float, *, pooled: int
) -> Floats:
    """Return for each sample the half window of least risk, shape (n,) [samples].

    The risk is that of `pooled` neighbouring blocks together, an odd number.
    """
    points = np.unique(np.linspace(0, values.size - 1, RISK_POINTS).astype(np.int64))
    risks = np.array(
        [risk(time_s, values, cuts, points, half, noise, memory) for half in HALF_WINDOWS]
    )
    blocks = np.array_split(np.arange(points.size), RISK_BLOCKS)
    mean = np.array([risks[:, block].mean(axis=1) for block in blocks if block.size])
    padded = np.pad(mean, ((pooled // 2, pooled // 2), (0, 0)), mode="edge")
    together = np.mean([padded[k : k + len(mean)] for k in range(pooled)], axis=0)
    chosen = np.log(UNDERSMOOTH * HALF_WINDOWS[np.argmin(together, axis=1)])
    centres = [points[block].mean() for block in blocks if block.size]
    half: Floats = np.round(np.exp(np.interp(np.arange(values.size), centres, chosen)))
    return half


@kernel
def quadratic_fit(
    time_s: Floats, values: Floats, i: int, first: int, last: int
) -> tuple[float, float, float, float]:
    """Fit a parabola to the samples first … last; return its value and slope at sample i.

    With them their variances for noise of variance one. Fewer than four samples give a line or
    the mean.
    """
    t1 = t2 = t3 = t4 = y0 = y1 = y2 = 0.0
    unit = (time_s[last] - time_s[first]) / max(last - first, 1)
    for j in range(first, last + 1):
        t = (time_s[j] - time_s[i]) / unit
        y = values[j] - values[i]
        tt = t * t
        t1 += t
        t2 += tt
        t3 += tt * t
        t4 += tt * tt
        y0 += y
        y1 += t * y
        y2 += tt * y
    count = last - first + 1.0
    if count < 3.0:
        return values[i] + y0 / count, 0.0, 1.0 / count, math.inf
    if count < 5.0:
        determinant = count * t2 - t1 * t1
        value, slope = (t2 * y0 - t1 * y1) / determinant, (count * y1 - t1 * y0) / determinant
        spread = count / determinant / unit**2
        return values[i] + value, slope / unit, t2 / determinant, spread
    # The first two rows of the inverse of [[count, t1, t2], [t1, t2, t3], [t2, t3, t4]].
    a, b, c = t2 * t4 - t3 * t3, t2 * t3 - t1 * t4, t1 * t3 - t2 * t2
    d, e = count * t4 - t2 * t2, t1 * t2 - count * t3
    determinant = count * a + t1 * b + t2 * c
    value = (a * y0 + b * y1 + c * y2) / determinant
    slope = (b * y0 + d * y1 + e * y2) / determinant
    return values[i] + value, slope / unit, a / determinant, d / determinant / unit**2


@kernel
def window_of(i: int, half: int, first: int, end: int) -> tuple[int, int]:
    """Return the window around sample i, inside the piece first … end−1."""
    return max(first, i - half), min(end - 1, i + half)


@kernel
def risk(
    time_s: Floats,
    values: Floats,
    cuts: Indices,
    points: Indices,
    half: int,
    noise: float,
    memory: float,
) -> Floats:
    """Return Stein's estimate of the squared error of the fit, at the given samples.

    It is (y − fit)² − σ² + 2 cov(y, fit); noise that keeps its value for `memory` samples has
    that many times the covariance.
    """
    out = np.empty(points.size)
    piece = 0
    for k in range(points.size):
        i = points[k]
        while i >= cuts[piece + 1]:
            piece += 1
        first, last = window_of(i, half, cuts[piece], cuts[piece + 1])
        value, _, weight, _ = quadratic_fit(time_s, values, i, first, last)
        weight = min(1.0, weight * memory)
        out[k] = (values[i] - value) ** 2 + (2.0 * weight - 1.0) * noise * noise
    return out


@kernel
def corners(time_s: Floats, values: Floats, half: int, noise: float) -> Indices:
    """Return where the slope jumps, as the bounds of the pieces between: 0, …, n.

    Past and future slopes are compared over one window each; of the samples nearer to each
    other than a window, the one with the largest jump is the corner.
    """
    n = values.size
    stride = max(1, half // 10)
    jump = np.zeros(n)
    for i in range(half, n - half, stride):
        jump[i] = slope_jump(time_s, values, i, half)
    found = [0]
    i = 0
    while i < n:
        if jump[i] > CORNER * noise:
            best = i
            for j in range(i, min(i + half, n)):
                if jump[j] > jump[best]:
                    best = j
            centre = best
            for j in range(max(half, centre - stride), min(n - half, centre + stride + 1)):
                jump[j] = slope_jump(time_s, values, j, half)
                if jump[j] > jump[best]:
                    best = j
            found.append(best)
            i = best + half
        i += 1
    found.append(n)
    return np.array(found, dtype=np.int64)


@kernel
def slope_jump(time_s: Floats, values: Floats, i: int, half: int) -> float:
    """Return the jump of the slope at sample i over its standard deviation for unit noise."""
    _, past, _, past_variance = quadratic_fit(time_s, values, i, i - half, i)
    _, future, _, future_variance = quadratic_fit(time_s, values, i, i, i + half)
    return abs(future - past) / math.sqrt(past_variance + future_variance)


@kernel
def smoothed(
    time_s: Floats, values: Floats, cuts: Indices, half: Floats, noise: float
) -> tuple[Floats, Floats]:
    """Return the local quadratic fits between the cuts and their standard deviations."""
    n = values.size
    out = np.empty(n)
    sd = np.empty(n)
    piece = 0
    for i in range(n):
        while i >= cuts[piece + 1]:
            piece += 1
        first, last = window_of(i, int(half[i]), cuts[piece], cuts[piece + 1])
        out[i], _, variance, _ = quadratic_fit(time_s, values, i, first, last)
        sd[i] = noise * math.sqrt(min(variance, 1.0))
    return out, sd


def lay_flat(
    time_s: Floats,
    values: Floats,
    smooth: Floats,
    sd: Floats,
    cuts: Indices,
    reach: int,
    noise: float,
) -> None:
    """Set pieces at rest to their mean, in place; what runs into them does not overshoot.

    A drift by a thousandth of a millimetre at rest would be a reversal to a hysteretic model.
    """
    for k, (first, end) in enumerate(pairwise(cuts)):
        if not at_rest(time_s[first:end], values[first:end], noise):
            continue
        level = float(values[first:end].mean())
        smooth[first:end] = level
        sd[first:end] = noise / math.sqrt(end - first)
        before = smooth[max(cuts[max(k - 1, 0)], first - reach) : first]
        after = smooth[end : min(cuts[min(k + 2, cuts.size - 1)], end + reach)][::-1]
        for beside in (before, after):  # both begin at their far ends
            if beside.size:
                limit = np.minimum if beside[0] < level else np.maximum
                beside[:] = limit(beside, level)


def at_rest(time_s: Floats, values: Floats, noise: float) -> bool:
    """Say whether a piece shows no trend, no bow and no more spread than its noise."""
    count = values.size
    if count < 2 * HALF_WINDOWS[0]:
        return False
    t = time_s - time_s.mean()
    bow = t * t - np.mean(t * t)
    shapes = [abs(float(s @ values)) / math.sqrt(float(s @ s)) for s in (t, bow)]
    excess = math.sqrt(count) * (float(values.var()) / noise**2 - 1.0)
    return max(shapes) < MOVES * noise and excess < 2.0 * MOVES


def monotone_between(values: Floats, turns: Indices) -> Floats:
    """Return the nearest signal that is monotone between the given indices (least squares)."""
    from scipy.optimize import isotonic_regression

    out = values.copy()
    for first, last in pairwise(turns):
        rising = bool(values[last] >= values[first])
        stroke = isotonic_regression(out[first : last + 1], increasing=rising)
        out[first : last + 1] = stroke.x
    return out
