"""Stop operators, the elements of generalised Maxwell slip, and curves of straight lines.

An element follows a displacement until it has moved by its width, and then yields: its state is the
share of its width, −1 to 1. A sum of elements with weights that are not negative only dissipates
(Prandtl and Ishlinskii; Al-Bender, Lampaert and Swevers 2005). So do elements whose spring has a
gap, as where parts with play rub: they alone can give a change after a reversal that is slow in its
middle.
"""

import math
from collections.abc import Sequence

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats, Values

ELEMENTS, GAPS, KNOTS = 6, 4, 5  # elements without and with a gap
RATIO = 0.25  # width of each element over that of the one before
GAP = 0.5  # share of the width of an element with a gap, within which its spring is loose


@kernel
def yielded(before: float, rise: float, limit: float) -> float:
    """Return an element's state after a rise of its input; it yields at ±limit (Prandtl)."""
    return min(max(before + rise, -limit), limit)


def widths_of(longest: float) -> Floats:
    """Return the widths of the elements without a gap, the longest first, shape (ELEMENTS,)."""
    return np.array([longest * RATIO**k for k in range(ELEMENTS)])


def widths_with_gaps(longest: float) -> Floats:
    """Return the widths of the elements with a gap, the longest first, shape (GAPS,)."""
    return np.array([longest * 0.5**k for k in range(GAPS)])


@kernel
def beyond_gap(states: Values) -> Values:
    """Return the force of springs with a gap over that at full width, of any shape [1]."""
    beyond: Values = np.sign(states) * np.maximum(np.abs(states) - GAP, 0.0) / (1.0 - GAP)
    return beyond


@kernel
def states_of(values: Floats, widths: Floats, memory: Floats) -> Floats:
    """Return the state of each element along a signal [1], shape (elements, n).

    `memory` has the value before the first one and the states there, shape (1 + elements,), updated
    in place; with NaN, at the start of a run, the elements are without force at the first value.
    """
    out = np.empty((widths.size, values.size))
    for i in range(values.size):
        move_elements(values[i], widths, memory)
        for k in range(widths.size):
            out[k, i] = memory[1 + k]
    return out


@kernel
def move_elements(value: float, widths: Floats, memory: Floats) -> None:
    """Move the elements to the next value of their input; `memory` is that of `states_of`."""
    rise = value - memory[0]
    for k in range(widths.size):
        memory[1 + k] = 0.0 if np.isnan(rise) else yielded(memory[1 + k], rise / widths[k], 1.0)
    memory[0] = value


@kernel
def curve_at(value: float, low: float, high: float, heights: Sequence[float] | Floats) -> float:
    """Return a curve of straight lines between heights at even distances, constant outside.

    NaN for NaN.
    """
    last = len(heights) - 1
    if np.isnan(value):
        return value
    if value <= low:
        return heights[0]
    if value >= high:
        return heights[last]
    place = (value - low) / (high - low) * last
    k = min(int(place), last - 1)
    return heights[k] + (place - k) * (heights[k + 1] - heights[k])


@kernel
def curve_of(values: Floats, low: float, high: float, heights: Sequence[float]) -> Floats:
    """Return `curve_at` for each of the values."""
    out = np.empty(values.size)
    for i in range(values.size):
        out[i] = curve_at(values[i], low, high, heights)
    return out


@kernel
def place_curve_at(value: float, low: float, high: float, heights: Floats) -> float:
    """Return `curve_at` that is 0 at the low end; `heights` are the others, shape (KNOTS − 1,)."""
    return curve_at(value, low, high, (0.0, heights[0], heights[1], heights[2], heights[3]))


@kernel
def speed_curve_at(speed: float, slow: float, fast: float, middle: float, highest: float) -> float:
    """Return a curve over the logarithm of the speed, 0 at the low speed and constant outside.

    The heights are those at the middle and at the high speed.
    """
    value = math.log(max(abs(speed), slow))
    return curve_at(value, math.log(slow), math.log(fast), (0.0, middle, highest))
