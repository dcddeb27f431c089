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
from tsas_cli.support.arrays import Floats

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


def beyond_gap(states: Floats) -> Floats:
    """Return the force of springs with a gap over that at full width, of any shape [1]."""
    return np.sign(states) * np.maximum(np.abs(states) - GAP, 0.0) / (1.0 - GAP)


@kernel
def states_of(values: Floats, widths: Floats, memory: Floats) -> Floats:
    """Return the state of each element along a signal [1], shape (elements, n).

    `memory` has the value before the first one and the states there, shape (1 + elements,), updated
    in place; with NaN, at the start of a run, the elements are without force at the first value.
    """
    out = np.empty((widths.size, values.size))
    last = memory[0]
    for k in range(widths.size):
        state, last = memory[1 + k], memory[0]
        for i in range(values.size):
            state = 0.0 if np.isnan(last) else yielded(state, (values[i] - last) / widths[k], 1.0)
            last = values[i]
            out[k, i] = state
        memory[1 + k] = state
    memory[0] = last
    return out


def curve_of(values: Floats, low: float, high: float, heights: Sequence[float]) -> Floats:
    """Return a curve of straight lines between heights at even distances, constant outside."""
    return np.interp(values, np.linspace(low, high, len(heights)), heights)


def speed_curve(speed: Floats, slow: float, fast: float, heights: Sequence[float]) -> Floats:
    """Return a curve over the logarithm of the speed, 0 at the low speed and constant outside.

    `heights` are those at the middle and at the high speed.
    """
    values = np.log(np.maximum(np.abs(speed), slow))
    return curve_of(values, math.log(slow), math.log(fast), (0.0, *heights))
