"""Sums over consecutive parts of a series, which begin at given samples."""

import numpy as np

from tsas_cli.numerics.compiled import kernel, summing_kernel
from tsas_cli.support.arrays import Floats, Indices


@kernel
def sums_of(values: Floats, starts: Indices) -> Floats:
    """Return the sum of each part, in half the time of numpy's `add.reduceat`."""
    out = np.zeros(starts.size)
    for k in range(starts.size):
        end = starts[k + 1] if k + 1 < starts.size else values.size
        for i in range(starts[k], end):
            out[k] += values[i]
    return out


@summing_kernel
def scaled_without_shape(
    values: Floats, scale: Floats, at: Indices, shape: Floats, starts: Indices
) -> Floats:
    """Return e − s (s·e) of each part, e the values over their scale at some samples, s its shape.

    Shapes (n,) of values and scale, (m,) of the samples `at` and of the shape.
    """
    out = np.empty(at.size)
    for k in range(starts.size):
        end = starts[k + 1] if k + 1 < starts.size else at.size
        along = 0.0
        for i in range(starts[k], end):
            out[i] = values[at[i]] / scale[at[i]]
            along += shape[i] * out[i]
        for i in range(starts[k], end):
            out[i] -= shape[i] * along
    return out
