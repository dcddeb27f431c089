"""Clean a measured input before it drives a hysteretic model, and say how.

Raw noise would turn into reversals, each of which meets the infinite stiffness of a turning
point. Three steps, none of which delays the signal:

1. Corners: where the slopes of quadratic fits to the past and to the future differ by far more
   than their noise, the signal is cut, so that sharp reversals and the ends of dwells stay sharp.
2. Between corners local polynomials of fourth degree. The window is the one with the least
   estimated risk (Stein's unbiased estimate), chosen anew along the signal: wide where the motion
   is smooth. A piece that does not move is its mean.
3. Between the reversals that stand out of the remaining noise, the nearest monotone signal in the
   least-squares sense (pool adjacent violators): no spurious reversal is left.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.local_polynomial import HALF_WINDOWS, best_half_windows, corners, smoothed
from tsas_cli.numerics.noise import noise_sd, quantisation_step
from tsas_cli.numerics.turning_points import turning_points

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

METHOD = (
    "local polynomials of fourth degree between corners, window of least risk; "
    "monotone between reversals"
)
MOVES = 4.0  # standard deviations by which a piece that moves departs from its mean
STANDS_OUT = 8.0  # standard deviations of the cleaned signal by which a reversal turns back
VISIBLE = 2.0  # and of the raw noise: a jump of the acceleration makes the fits swing a little


@dataclass(frozen=True)
class Conditioned:
    """A cleaned signal, shape (n,), in the unit of the raw one.

    `sd` is the standard deviation of its error per sample, `unseen` what was taken off so that it
    turns at the reversals only, `window_s` the median window, `noise` the raw noise, `reversals`
    the indices of the extrema that were kept, with both ends, `smallest_reversal` the smallest
    move back that was told from noise.
    """

    values: Floats
    sd: Floats
    unseen: Floats
    window_s: float
    noise: float
    reversals: Indices
    smallest_reversal: float = 0.0


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
    noise, memory = noise_and_memory(values)
    if not noise > 0.0:  # noise-free, or too short to tell
        nothing = np.zeros(values.size)
        return Conditioned(values, nothing, nothing, 0.0, 0.0, turning_points(values, 0.0))
    smooth, sd, window_s = smooth_out(time_s, values, noise, memory)
    threshold = smallest_reversal(sd, noise)
    reversals = turning_points(smooth, threshold)
    clean = monotone_between(smooth, reversals)
    return Conditioned(clean, sd, smooth - clean, window_s, noise, reversals, threshold)


def noise_and_memory(values: Floats) -> tuple[float, float]:
    """Return the noise of a signal, quantisation counted in, and for how many samples it lasts."""
    step = quantisation_step(values)
    noise = max(noise_sd(values), step / math.sqrt(12.0))
    return noise, _plateau(values) if step > 0.0 else 1.0


def smooth_out(
    time_s: Floats, values: Floats, noise: float, memory: float
) -> tuple[Floats, Floats, float]:
    """Fit the signal between its corners; return it, its standard deviation, the window [s]."""
    whole = np.array([0, values.size], dtype=np.int64)
    # Corners spoil the blocks that they lie in; the smooth blocks tell the window to seek them by.
    alone = best_half_windows(time_s, values, whole, noise, memory, degree=2, pooled=1)
    cuts = corners(time_s, values, int(np.percentile(alone, 75)), noise * math.sqrt(memory))
    half = best_half_windows(time_s, values, cuts, noise, memory, degree=4, pooled=5)
    smooth, sd = smoothed(time_s, values, cuts, half, noise * math.sqrt(memory))
    blunt(smooth, cuts)
    lay_flat(time_s, values, smooth, sd, cuts, int(np.median(half)), noise * math.sqrt(memory))
    return smooth, sd, float(np.median(2 * half + 1) * np.median(np.diff(time_s)))


def smallest_reversal(sd: Floats, noise: float) -> float:
    """Return the smallest move back that stands out of a cleaned signal's noise."""
    return max(STANDS_OUT * float(np.median(sd)), VISIBLE * noise)


def _with_gaps(cleaned: Conditioned, time_s: Floats, there: Indices) -> Conditioned:
    """Lay a signal that was cleaned at some samples over all of them, straight in between."""
    reversals = there[cleaned.reversals]
    reversals[0], reversals[-1] = 0, time_s.size - 1
    return replace(
        cleaned,
        values=np.interp(time_s, time_s[there], cleaned.values),
        sd=np.interp(time_s, time_s[there], cleaned.sd),
        unseen=np.interp(time_s, time_s[there], cleaned.unseen),
        reversals=reversals,
    )


def _plateau(values: Floats) -> float:
    """Return the mean number of samples that a quantised signal stays at one level."""
    return values.size / (1.0 + np.count_nonzero(np.diff(values)))


def blunt(smooth: Floats, cuts: Indices) -> None:
    """Take off, in place, what a fit overshoots where its piece begins a sample off the corner.

    At a peak the sample of the corner lies below the lines of both sides, in a valley above.
    """
    for cut in cuts[1:-1]:
        if cut < 2 or cut + 1 >= smooth.size:
            continue
        rise, fall = smooth[cut - 1] - smooth[cut - 2], smooth[cut + 1] - smooth[cut]
        before = smooth[cut - 1] + rise
        if rise * fall < 0.0:
            smooth[cut] = min(smooth[cut], before) if rise > 0.0 else max(smooth[cut], before)


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
