"""Clean a measured input before it drives a hysteretic model.

Raw noise would become reversals, each of which meets the infinite stiffness of a turning point.
Three steps, none of which delays the signal:

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

from tsas_cli.numerics.local_polynomial import (
    COARSE,
    HALF_WINDOWS,
    best_half_windows,
    corners,
    smoothed,
)
from tsas_cli.numerics.noise import Noise, noise_of, with_memory
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.support.arrays import Floats, Indices

METHOD = (
    "local polynomials of fourth degree between corners, window of least risk; "
    "monotone between reversals"
)
SHORTEST_BESIDE_CORNER = 4  # samples; to a line of fewer every acceleration is a corner
MOVES = 4.0  # standard deviations by which a piece that moves departs from its mean
STILL = 6.0  # standard deviations by which what rests moves in a window, at most
MISSED = 4.0  # standard deviations by which a fit of few samples misses the signal
SMOOTH = 0.5  # of a reversal's second difference, by those beside it at least
REVERSAL_SD = 8.0  # smallest reversal, in standard deviations of the cleaned signal
KEPT = 0.8  # of the noise: what the values keep of it makes the windows of the next fits narrower
DRAWS = 4  # of noise, by which the error of a cleaned signal is estimated
REVERSAL_NOISE = 2.0  # and of the raw noise: fits overshoot where the acceleration jumps


@dataclass(frozen=True)
class Conditioned:
    """A cleaned signal, shape (n,), in the unit of the raw one.

    `sd` is the standard deviation of its error per sample, `unseen` the correction that makes it
    monotone between reversals, `window_s` the median window, `noise` the raw noise, `reversals`
    the indices of the extrema, with both ends, `smallest_reversal` the amplitude below which a
    reversal counts as noise, `step` the quantisation step, `correlation` that of the noise of
    neighbouring samples; `recorded` are the samples that are no gap, all without it.
    """

    values: Floats
    sd: Floats
    unseen: Floats
    window_s: float
    noise: float
    reversals: Indices
    smallest_reversal: float = 0.0
    step: float = 0.0
    correlation: float = 0.0
    recorded: Indices | None = None

    def again(self, time_s: Floats, every: int = 1) -> list[Floats]:
        """Return the values cleaned once more, with noise and rounding like those of the raw ones.

        The difference of each is an error such as the values themselves have. They are one in
        `every` of the samples that were cleaned. The noise is the same in every call.
        """
        at = slice(None) if self.recorded is None else self.recorded
        white = KEPT * math.sqrt(max(self.noise**2 - self.step**2 / 12.0, 0.0) / every)
        random, out = np.random.default_rng(0), []
        for _ in range(DRAWS):
            noisy = np.full(self.values.size, math.nan)
            drawn = random.standard_normal(self.values[at].size)
            noisy[at] = self.values[at] + white * with_memory(drawn, self.correlation)
            if self.step > 0.0 and every == 1:
                noisy = self.step * np.round(noisy / self.step)
            out.append(condition(time_s, noisy).values)
        return out


def condition(time_s: Floats, values: Floats) -> Conditioned:
    """Return the cleaned signal of times and values, shape (n,).

    The times increase, evenly or not; NaN in the values is a gap, filled by a straight line.
    """
    finite = np.flatnonzero(np.isfinite(values))
    if finite.size < values.size:
        cleaned = condition(time_s[finite], values[finite])
        reversals = finite[cleaned.reversals]
        reversals[0], reversals[-1] = 0, time_s.size - 1
        series = cleaned.values, cleaned.sd, cleaned.unseen
        clean, sd, unseen = (np.interp(time_s, time_s[finite], each) for each in series)
        return replace(
            cleaned, values=clean, sd=sd, unseen=unseen, reversals=reversals, recorded=finite
        )
    noise = noise_of(values, time_s)
    if not noise.sd > 0.0:  # noise-free, or too short for an estimate
        nothing = np.zeros(values.size)
        return Conditioned(values, nothing, nothing, 0.0, 0.0, turning_points(values, 0.0))
    smooth, sd, window_s = smooth_out(time_s, values, noise.sd, memory_of(values, noise))
    threshold = smallest_reversal(sd, noise.sd)
    reversals = turning_points(smooth, threshold)
    clean = with_turning_points(monotone_between(smooth, reversals), reversals)
    return Conditioned(
        clean,
        sd,
        smooth - clean,
        window_s,
        noise.sd,
        reversals,
        threshold,
        noise.step,
        noise.correlation,
    )


def memory_of(values: Floats, noise: Noise) -> float:
    """Return for how many samples the error of a signal persists."""
    plateau = values.size / (1.0 + np.count_nonzero(np.diff(values)))  # mean samples at one level
    correlated = float(noise.growth(np.array(float(values.size))))
    return max(plateau if noise.step > 0.0 else 1.0, correlated)


def smooth_out(
    time_s: Floats, values: Floats, noise: float, memory: float
) -> tuple[Floats, Floats, float]:
    """Return the signal fitted between its corners, its standard deviation and the window [s]."""
    whole = np.array([0, values.size], dtype=np.int64)
    # Corners spoil the blocks that they lie in; the smooth blocks give the window of the search.
    alone = best_half_windows(time_s, values, whole, noise, memory, degree=2, pooled=1)
    beside = max(SHORTEST_BESIDE_CORNER, int(np.percentile(alone, 75)))
    of_mean = noise * math.sqrt(memory)  # white noise whose means scatter as much
    cuts = corners(time_s, values, beside, of_mean)
    half = best_half_windows(time_s, values, cuts, noise, memory, degree=4, pooled=5)
    smooth, sd = smoothed(time_s, values, cuts, half, of_mean)
    remove_overshoot(smooth, cuts)
    follow_corners(values, smooth, sd, half, of_mean)
    flatten_rests(time_s, values, smooth, sd, cuts, int(np.median(half)), of_mean)
    return smooth, sd, float(np.median(2 * half + 1) * np.median(np.diff(time_s)))


def smallest_reversal(sd: Floats, noise: float) -> float:
    """Return the amplitude below which a reversal of a cleaned signal counts as noise."""
    return max(REVERSAL_SD * float(np.median(sd)), REVERSAL_NOISE * noise)


def remove_overshoot(smooth: Floats, cuts: Indices) -> None:
    """Remove, in place, the overshoot of a fit whose piece begins a sample off the corner.

    At a peak the sample of the corner lies below the lines of both sides, in a valley above.
    """
    for cut in cuts[1:-1]:
        if cut < 2 or cut + 1 >= smooth.size:
            continue
        rise, fall = smooth[cut - 1] - smooth[cut - 2], smooth[cut + 1] - smooth[cut]
        before = smooth[cut - 1] + rise
        if rise * fall < 0.0:
            smooth[cut] = min(smooth[cut], before) if rise > 0.0 else max(smooth[cut], before)


def follow_corners(values: Floats, smooth: Floats, sd: Floats, half: Floats, noise: float) -> None:
    """Set, in place, the values that a fit of few samples misses by far to the measured ones.

    At coarse rates neither a cut nor a polynomial follows a rounded corner. What alternates is
    left to the fit: it rings, as after a jump, and each turn would be a reversal of the tendon.
    """
    turns = np.pad(np.diff(np.sign(np.diff(values))) != 0, 1)
    alternates = np.convolve(turns, np.ones(5), "same") > 1  # turns of five samples
    missed = (half <= COARSE) & (np.abs(values - smooth) > MISSED * noise) & ~alternates
    smooth[missed] = values[missed]
    sd[missed] = noise


def flatten_rests(
    time_s: Floats,
    values: Floats,
    smooth: Floats,
    sd: Floats,
    cuts: Indices,
    reach: int,
    noise: float,
) -> None:
    """Set what is at rest to its mean, in place, and straighten the motion beside it.

    To a hysteretic model a drift of a thousandth of a millimetre at rest would be a reversal. A
    rest is a whole piece, or lies inside one where the motion ends without a corner; there its
    ends are not known, and the error stays that of the fit. One that a corner of noise cuts is one
    rest: else each part would have its own mean, and the tendon would turn between them.
    """
    rests: list[tuple[int, int]] = []
    for first, end in pairwise(cuts):
        parts = [
            (first + a, first + b) for a, b in still_parts(smooth[first:end], sd[first:end], reach)
        ]
        if at_rest(time_s[first:end], values[first:end], noise):
            parts = [(first, end)]
            sd[first:end] = noise / math.sqrt(end - first)
        for part in parts:
            begun = rests[-1][0] if rests else part[0]
            if at_rest(time_s[begun : part[1]], values[begun : part[1]], noise):
                rests[-1:] = [(begun, part[1])]
            elif at_rest(time_s[slice(*part)], values[slice(*part)], noise):
                rests.append(part)
    between = [0, *(edge for rest in rests for edge in rest), values.size]
    for k, (first, end) in enumerate(rests):
        level = smooth[first:end] = float(values[first:end].mean())
        before, after = smooth[between[2 * k] : first][::-1], smooth[end : between[2 * k + 3]]
        straighten(before, level, REVERSAL_NOISE * noise)
        straighten(after, level, REVERSAL_NOISE * noise)


def straighten(beside: Floats, level: float, near: float) -> None:
    """Let a signal run to a rest's level one way, in place, over the samples that are near it.

    `beside` begins at the rest. What overshoots the level, or reverses before it, is noise.
    """
    away = np.flatnonzero(np.abs(beside - level) > near)
    if away.size:
        farthest = np.maximum if beside[away[0]] < level else np.minimum
        nearest = np.minimum if beside[away[0]] < level else np.maximum
        towards = farthest.accumulate(beside[: away[0]][::-1])[::-1]
        beside[: away[0]] = nearest(towards, level)


def still_parts(smooth: Floats, sd: Floats, reach: int) -> list[tuple[int, int]]:
    """Return the parts of a piece that moves in which the cleaned signal moves no more than errs.

    Over a window, `reach` samples to either side; the windows at both ends are left out, since the
    motion ends in them.
    """
    if smooth.size <= 2 * reach:
        return []
    moved = np.abs(smooth[2 * reach :] - smooth[: -2 * reach])
    still = moved < STILL * sd[reach : smooth.size - reach]
    edges = np.flatnonzero(np.diff(still, prepend=False, append=False)) + reach
    runs = zip(edges[::2] + reach, edges[1::2] - reach, strict=True)
    return [(int(a), int(b)) for a, b in runs if b - a > reach]


def at_rest(time_s: Floats, values: Floats, noise: float) -> bool:
    """Return whether a piece shows no trend, no curvature and no more variance than its noise."""
    count = values.size
    if count < 2 * HALF_WINDOWS[0]:
        return False
    t = time_s - time_s.mean()
    bow = t * t - np.mean(t * t)
    shapes = [abs(float(s @ values)) / math.sqrt(float(s @ s)) for s in (t, bow)]
    excess = math.sqrt(count) * (float(values.var()) / noise**2 - 1.0)
    return max(shapes) < MOVES * noise and excess < 2.0 * MOVES


def monotone_between(values: Floats, reversals: Indices) -> Floats:
    """Return the nearest signal (least squares) that is monotone between the given indices."""
    from scipy.optimize import isotonic_regression

    out = values.copy()
    for first, last in pairwise(reversals):
        rising = bool(values[last] >= values[first])
        stroke = isotonic_regression(out[first : last + 1], increasing=rising)
        out[first : last + 1] = stroke.x
    return out


def with_turning_points(values: Floats, reversals: Indices) -> Floats:
    """Return the values with those of smooth reversals at the vertex of the parabola through three.

    The motion turns between two samples, beyond both. A reversal is smooth where the second
    differences beside it are half of its own or more: not at a corner or the end of a rest.
    """
    out = values.copy()
    at = reversals[(reversals > 1) & (reversals < values.size - 2)]
    bow = np.diff(values, 2)  # of sample k + 1
    turn = bow[at - 1]
    smooth = np.minimum(bow[at - 2] * turn, bow[at] * turn) > SMOOTH * turn**2
    at, turn = at[smooth], turn[smooth]
    out[at] -= (values[at + 1] - values[at - 1]) ** 2 / (8.0 * turn)
    return out
