"""What drives the dynamic chain between samples: a curve through them that turns only at them.

Drive and load follow the monotone piecewise cubic of Fritsch and Butland (SIAM Journal on
Scientific and Statistical Computing 5, 1984), which has a speed at every time; friction and
preload go straight from sample to sample.
"""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.lugre.state import Floats, Formula, Step

DRIVE, LOAD, PULLED, RELEASED, LOST = 0, 1, 2, 3, 5  # rows of the course


@kernel
def slope_at(times: Floats, course: Floats, row: int, k: int) -> float:
    """Return the curve's slope at a sample; 0 where the samples turn or stand still."""
    last = times.size - 1
    if last == 0:
        return 0.0
    if k in (0, last):
        return slope_at_end(times, course, row, k)
    before, after = times[k] - times[k - 1], times[k + 1] - times[k]
    a = (course[row, k] - course[row, k - 1]) / before
    b = (course[row, k + 1] - course[row, k]) / after
    if a * b <= 0.0:
        return 0.0
    near, far = 2.0 * after + before, after + 2.0 * before
    return float((near + far) * a * b / (near * b + far * a))


@kernel
def slope_at_end(times: Floats, course: Floats, row: int, k: int) -> float:
    """Return the slope at the first or last sample: a parabola's, made to keep the shape."""
    towards = 1 if k == 0 else -1
    h = times[k + towards] - times[k]
    a = (course[row, k + towards] - course[row, k]) / h
    if times.size == 2:
        return float(a)
    h_next = times[k + 2 * towards] - times[k + towards]
    b = (course[row, k + 2 * towards] - course[row, k + towards]) / h_next
    slope = ((2.0 * h + h_next) * a - h * b) / (h + h_next)
    if slope * a <= 0.0:
        return 0.0
    if a * b <= 0.0 and abs(slope) > 3.0 * abs(a):
        return float(3.0 * a)
    return float(slope)


@kernel
def hermite(part: float, h: float, x0: float, v0: float, x1: float, v1: float) -> float:
    """Return the cubic with these values and slopes at both ends, at a part of the way."""
    left = 1.0 - part
    ends = x0 * (1.0 + 2.0 * part) * left * left + x1 * part * part * (3.0 - 2.0 * part)
    return ends + h * part * left * (v0 * left - v1 * part)


@kernel
def hermite_slope(part: float, h: float, x0: float, v0: float, x1: float, v1: float) -> float:
    """Return the slope of `hermite`."""
    left = 1.0 - part
    return (
        6.0 * part * left * (x1 - x0) / h
        + v0 * left * (1.0 - 3.0 * part)
        - v1 * part * (2.0 - 3.0 * part)
    )


@kernel
def value_at(times: Floats, course: Floats, row: int, k: int, t: float) -> tuple[float, float]:
    """Return value and slope of drive or load at a time from sample k to the next."""
    for at in (k, k + 1):
        if t == times[at]:
            return course[row, at], slope_at(times, course, row, at)
    h = times[k + 1] - times[k]
    part = (t - times[k]) / h
    x0, x1 = course[row, k], course[row, k + 1]
    v0, v1 = slope_at(times, course, row, k), slope_at(times, course, row, k + 1)
    return hermite(part, h, x0, v0, x1, v1), hermite_slope(part, h, x0, v0, x1, v1)


@kernel
def step_at(
    times: Floats,
    course: Floats,
    k: int,
    t: float,
    formula: Formula,
    drives: tuple[float, float],
    n: int,
    boundary: Boundary,
) -> Step:
    """Return what is given at the end of a step, at a time from sample k to the next.

    `drives` is what was given there at the ends of the last two steps.
    """
    drive, rate = value_at(times, course, DRIVE, k, t)
    load, load_rate = 0.0, 0.0
    if boundary.load != SPRING:
        load, load_rate = value_at(times, course, LOAD, k, t)
    part = (t - times[k]) / (times[k + 1] - times[k])
    pulled = course[PULLED, k] + part * (course[PULLED, k + 1] - course[PULLED, k])
    released = course[RELEASED, k] + part * (course[RELEASED, k + 1] - course[RELEASED, k])
    lost = course[LOST, k] + part * (course[LOST, k + 1] - course[LOST, k])
    framed = 1.0 if boundary.drive == DISPLACEMENT else 0.0
    moved = drive - formula.near * drives[0] + formula.far * drives[1]
    limits = lump_share(pulled, n)
    return Step(
        formula.gh,
        drive,
        rate,
        load,
        load_rate,
        framed * drive,
        framed * moved / formula.gh,
        limits,
        limits if released == pulled else lump_share(released, n),
        lost,
    )


@kernel
def lump_share(wrap: float, n: int) -> float:
    """Return the limit of a lump's friction over its mean tension, of n that share a wrap."""
    return float(2.0 * np.tanh(0.5 * wrap / n))


@kernel
def next_reversal(times: Floats, course: Floats, k: int, boundary: Boundary) -> int:
    """Return the first sample after k at which drive or load turns, stops or sets off."""
    last = times.size - 1
    for i in range(k + 1, last):
        if reverses(course, DRIVE, i) or (boundary.load != SPRING and reverses(course, LOAD, i)):
            return i
    return last


@kernel
def reverses(course: Floats, row: int, i: int) -> bool:
    """Say whether a row turns, stops or sets off at a sample between others."""
    before, after = course[row, i] - course[row, i - 1], course[row, i + 1] - course[row, i]
    return bool(before * after <= 0.0 and before != after)
