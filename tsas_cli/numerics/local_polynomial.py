"""Local polynomial fits to a sampled signal: the window of least risk, and where slopes jump.

The signal is cut at its corners into pieces, given by their bounds 0, …, n; a window never
crosses a cut. Inside a piece a polynomial of fourth degree is fitted, which follows a turning
point and so allows a wide window; where a cut shortens the window, a parabola, which has less
variance at the edge. Times need not be even.
"""

import math

import numpy as np

from tsas_cli.numerics.compiled import kernel, summing_kernel
from tsas_cli.support.arrays import Floats, Indices

HALF_WINDOWS = np.array([3, 5, 8, 12, 18, 27, 40, 60, 90, 135, 200, 300, 450, 700, 1000])  # samples
RISK_POINTS = 2000  # samples at which the risk is estimated, evenly spread
RISK_BLOCKS = 40  # pieces of the signal that may have windows of their own
UNDERSMOOTH = 0.75  # of the window of least risk: a hysteretic model tolerates noise, not bias
CORNER = 6.0  # standard deviations of the difference of two slopes
COARSE = 8  # samples: in such a window, and a shorter one, a smooth turn changes its curvature
KINK = 4.0  # standard deviations there, beside a quartic that follows the turn


def best_half_windows(
    time_s: Floats,
    values: Floats,
    cuts: Indices,
    noise: float,
    memory: float,
    *,
    degree: int,
    pooled: int,
) -> Floats:
    """Return for each sample the half window of least risk, shape (n,) [samples].

    The risk is that of fits of degree 2 or 4, of `pooled` neighbouring blocks together, an odd
    number.
    """
    points = np.unique(np.linspace(0, values.size - 1, RISK_POINTS).astype(np.int64))
    risks = np.array(
        [risk(time_s, values, cuts, points, half, degree, noise, memory) for half in HALF_WINDOWS]
    )
    blocks = np.array_split(np.arange(points.size), RISK_BLOCKS)
    mean = np.array([risks[:, block].mean(axis=1) for block in blocks if block.size])
    padded = np.pad(mean, ((pooled // 2, pooled // 2), (0, 0)), mode="edge")
    together = np.mean([padded[k : k + len(mean)] for k in range(pooled)], axis=0)
    chosen = np.log(UNDERSMOOTH * HALF_WINDOWS[np.argmin(together, axis=1)])
    centres = [points[block].mean() for block in blocks if block.size]
    half: Floats = np.round(np.exp(np.interp(np.arange(values.size), centres, chosen)))
    return half


@summing_kernel
def quadratic_fit(
    time_s: Floats, values: Floats, i: int, first: int, last: int
) -> tuple[float, float, float, float]:
    """Return value and slope at sample i of the parabola through the samples first … last.

    With their variances for noise of variance one. Few samples give a line, two the value itself.
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
        return values[i], 0.0, 1.0, math.inf
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


@summing_kernel
def quartic_fit(
    time_s: Floats, values: Floats, i: int, first: int, last: int
) -> tuple[float, float]:
    """Return the value at sample i of the quartic fitted to first … last, and its variance.

    At least nine samples; the variance is for noise of variance one.
    """
    unit = 0.5 * (time_s[last] - time_s[first])
    t1 = t2 = t3 = t4 = t5 = t6 = t7 = t8 = y0 = y1 = y2 = y3 = y4 = 0.0
    for j in range(first, last + 1):
        t = (time_s[j] - time_s[i]) / unit
        y = values[j] - values[i]
        tt = t * t
        t1 += t
        t2 += tt
        t3 += tt * t
        t4 += tt * tt
        t5 += tt * tt * t
        t6 += tt * tt * tt
        t7 += tt * tt * tt * t
        t8 += tt * tt * tt * tt
        y0 += y
        y1 += t * y
        y2 += tt * y
        y3 += tt * t * y
        y4 += tt * tt * y
    moments = np.array([last - first + 1.0, t1, t2, t3, t4, t5, t6, t7, t8])
    weights = first_row_of_inverse(moments)
    return values[i] + float(np.sum(weights * np.array([y0, y1, y2, y3, y4]))), weights[0]


@kernel
def first_row_of_inverse(moments: Floats) -> Floats:
    """Return the first row of the inverse of the matrix of moments[row + column], shape (5,).

    The matrix is positive definite: elimination needs no pivots.
    """
    A = np.empty((5, 6))
    for row in range(5):
        for column in range(5):
            A[row, column] = moments[row + column]
        A[row, 5] = 1.0 if row == 0 else 0.0
    for pivot in range(5):
        for row in range(5):
            if row != pivot:
                factor = A[row, pivot] / A[pivot, pivot]
                for column in range(pivot, 6):
                    A[row, column] -= factor * A[pivot, column]
    return np.array([A[row, 5] / A[row, row] for row in range(5)])


@kernel
def local_fit(
    time_s: Floats, values: Floats, i: int, half: int, start: int, end: int, degree: int
) -> tuple[float, float]:
    """Return value and variance of the fit around sample i inside the piece start … end−1.

    The fourth degree is for windows of nine samples or more that no corner shortens.
    """
    first, last = max(start, i - half), min(end - 1, i + half)
    cornered = (first > i - half and start > 0) or (last < i + half and end < values.size)
    if degree == 4 and last - first >= 8 and not cornered:
        return quartic_fit(time_s, values, i, first, last)
    value, _, variance, _ = quadratic_fit(time_s, values, i, first, last)
    return value, variance


@kernel
def risk(
    time_s: Floats,
    values: Floats,
    cuts: Indices,
    points: Indices,
    half: int,
    degree: int,
    noise: float,
    memory: float,
) -> Floats:
    """Return Stein's estimate of the squared error of the fit, at the given samples.

    It is (y − fit)² − σ² + 2 cov(y, fit); noise that is constant over `memory` samples has that
    many times the covariance.
    """
    out = np.empty(points.size)
    piece = 0
    for k in range(points.size):
        i = points[k]
        while i >= cuts[piece + 1]:
            piece += 1
        value, weight = local_fit(time_s, values, i, half, cuts[piece], cuts[piece + 1], degree)
        weight = min(1.0, weight * memory)
        out[k] = (values[i] - value) ** 2 + (2.0 * weight - 1.0) * noise * noise
    return out


@kernel
def corners(time_s: Floats, values: Floats, half: int, noise: float) -> Indices:
    """Return the samples at which the slope jumps, as bounds of the pieces between: 0, …, n.

    Past and future slopes are compared over one window each; of samples closer together than a
    window, the one with the largest jump is the corner.
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
            if half > COARSE or kink(time_s, values, best, half) > KINK * noise:
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
def kink(time_s: Floats, values: Floats, i: int, half: int) -> float:
    """Return the jump of the slope at sample i beside a quartic, over its standard deviation.

    Where samples are few the curvature of a smooth turn changes within a window, which parabolas to
    both sides take for a jump.
    """
    unit = 0.5 * (time_s[i + half] - time_s[i - half])
    A, b = np.zeros((6, 6)), np.zeros(6)
    row = np.empty(6)
    for j in range(i - half, i + half + 1):
        t = (time_s[j] - time_s[i]) / unit
        row[0], row[1], row[2], row[3], row[4], row[5] = 1.0, t, t**2, t**3, t**4, abs(t)
        for k in range(6):
            b[k] += row[k] * (values[j] - values[i])
            for m in range(6):
                A[k, m] += row[k] * row[m]
    if np.linalg.matrix_rank(A) < row.size:  # stamps in batches: no slope is known
        return 0.0
    inverse = np.linalg.inv(A)
    return abs(float(np.sum(inverse[5] * b))) / math.sqrt(inverse[5, 5])


@kernel
def smoothed(
    time_s: Floats, values: Floats, cuts: Indices, half: Floats, noise: float
) -> tuple[Floats, Floats]:
    """Return the local fits of fourth degree and their standard deviations."""
    n = values.size
    out = np.empty(n)
    sd = np.empty(n)
    piece = 0
    for i in range(n):
        while i >= cuts[piece + 1]:
            piece += 1
        out[i], variance = local_fit(
            time_s, values, i, int(half[i]), cuts[piece], cuts[piece + 1], 4
        )
        sd[i] = noise * math.sqrt(min(variance, 1.0))
    return out, sd
