"""Input of the dynamic chain between samples: a curve that reverses at samples only.

Drive and load follow the monotone piecewise cubic of Fritsch and Butland (SIAM Journal on
Scientific and Statistical Computing 5, 1984), which is differentiable; friction and preload are
interpolated linearly.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING
from tsas_cli.physics.course import DRIVE, LOAD, TIME, losses_between, losses_of
from tsas_cli.physics.lugre.state import Formula, Given, LugreLaws, Step
from tsas_cli.support.arrays import Floats


class Cubic(NamedTuple):
    """A cubic over a step, by its values and slopes at both ends."""

    x0: float
    v0: float
    x1: float
    v1: float


@kernel
def slope_at(course: Floats, row: int, k: int) -> float:
    """Return the curve's slope at a sample; 0 where the samples reverse or rest."""
    last = course.shape[1] - 1
    if last == 0:
        return 0.0
    if k in (0, last):
        return slope_at_end(course, row, k)
    before, after = course[TIME, k] - course[TIME, k - 1], course[TIME, k + 1] - course[TIME, k]
    a = (course[row, k] - course[row, k - 1]) / before
    b = (course[row, k + 1] - course[row, k]) / after
    if a * b <= 0.0:
        return 0.0
    near, far = 2.0 * after + before, after + 2.0 * before
    return float((near + far) * a * b / (near * b + far * a))


@kernel
def slope_at_end(course: Floats, row: int, k: int) -> float:
    """Return the slope at the first or last sample: a parabola's, limited to preserve the shape."""
    towards = 1 if k == 0 else -1
    h = course[TIME, k + towards] - course[TIME, k]
    a = (course[row, k + towards] - course[row, k]) / h
    if course.shape[1] == 2:
        return float(a)
    h_next = course[TIME, k + 2 * towards] - course[TIME, k + towards]
    b = (course[row, k + 2 * towards] - course[row, k + towards]) / h_next
    slope = ((2.0 * h + h_next) * a - h * b) / (h + h_next)
    if slope * a <= 0.0:
        return 0.0
    if a * b <= 0.0 and abs(slope) > 3.0 * abs(a):
        return float(3.0 * a)
    return float(slope)


@kernel
def hermite(part: float, h: float, ends: Cubic) -> float:
    """Return a cubic at a part of a step h."""
    left = 1.0 - part
    x = ends.x0 * (1.0 + 2.0 * part) * left * left + ends.x1 * part * part * (3.0 - 2.0 * part)
    return x + h * part * left * (ends.v0 * left - ends.v1 * part)


@kernel
def hermite_slope(part: float, h: float, ends: Cubic) -> float:
    """Return the slope of `hermite`."""
    left = 1.0 - part
    return (
        6.0 * part * left * (ends.x1 - ends.x0) / h
        + ends.v0 * left * (1.0 - 3.0 * part)
        - ends.v1 * part * (2.0 - 3.0 * part)
    )


@kernel
def value_at(course: Floats, row: int, k: int, t: float) -> Given:
    """Return value and slope of drive or load at a time from sample k to the next."""
    for at in (k, k + 1):
        if t == course[TIME, at]:
            return Given(course[row, at], slope_at(course, row, at))
    h = course[TIME, k + 1] - course[TIME, k]
    part = (t - course[TIME, k]) / h
    v0, v1 = slope_at(course, row, k), slope_at(course, row, k + 1)
    ends = Cubic(course[row, k], v0, course[row, k + 1], v1)
    return Given(hermite(part, h, ends), hermite_slope(part, h, ends))


@kernel
def step_at(
    course: Floats, k: int, t: float, formula: Formula, drives: tuple[float, float], laws: LugreLaws
) -> Step:
    """Return the inputs at the end of a step, at a time from sample k to the next.

    `drives` are the given quantity of the drive at the ends of the last two steps.
    """
    drive = value_at(course, DRIVE, k, t)
    load = Given(0.0, 0.0)
    if laws.load.given != SPRING:
        load = value_at(course, LOAD, k, t)
    part = (t - course[TIME, k]) / (course[TIME, k + 1] - course[TIME, k])
    now = losses_between(losses_of(course, k), losses_of(course, k + 1), part)
    framed = 1.0 if laws.drive.given == DISPLACEMENT else 0.0
    moved = drive.value - formula.near * drives[0] + formula.far * drives[1]
    frame = Given(framed * drive.value, framed * moved / formula.gh)
    pulled = lump_share(now.pulled, laws.n)
    released = pulled if now.released == now.pulled else lump_share(now.released, laws.n)
    return Step(formula.gh, drive, load, frame, pulled, released, now.preload_N)


@kernel
def lump_share(wrap: float, n: int) -> float:
    """Return the limit of a lump's friction over its mean tension, for n lumps of a wrap."""
    return float(2.0 * np.tanh(0.5 * wrap / n))


@kernel
def next_reversal(course: Floats, k: int, laws: LugreLaws) -> int:
    """Return the first sample after k at which drive or load reverses, stops or starts."""
    last: int = course.shape[1] - 1
    by_spring = laws.load.given == SPRING
    for i in range(k + 1, last):
        if reverses(course, DRIVE, i) or (not by_spring and reverses(course, LOAD, i)):
            return i
    return last


@kernel
def reverses(course: Floats, row: int, i: int) -> bool:
    """Return whether an input reverses, stops or starts at an inner sample."""
    before, after = course[row, i] - course[row, i - 1], course[row, i + 1] - course[row, i]
    return bool(before * after <= 0.0 and before != after)
