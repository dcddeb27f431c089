"""Reversals of a sampled motion, separated from noise by a threshold."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats, Indices


@kernel
def turning_points(values: Floats, threshold: float, direction: int = 0) -> Indices:
    """Return the indices of the extrema between which the signal moves by more than a threshold.

    The first and the last sample are always included, so that neighbouring indices bound the
    strokes. Extrema alternate; a flat extremum counts at its first sample. The values are finite,
    shape (n,), the threshold is in their unit. Where the signal continues a longer one, `direction`
    is that of its first stroke, 1 or −1; else 0.
    """
    n = values.size
    found = np.zeros(n, dtype=np.int64)
    if n == 0:
        return found
    count = 1
    low = 0
    high = 0
    for i in range(1, n):
        if values[i] > values[high]:
            high = i
        if values[i] < values[low]:
            low = i
        if direction >= 0 and values[high] - values[i] > threshold:
            if direction == 1:
                found[count] = high
                count += 1
            direction = -1
            low = i
            high = i
        elif direction <= 0 and values[i] - values[low] > threshold:
            if direction == -1:
                found[count] = low
                count += 1
            direction = 1
            low = i
            high = i
    if found[count - 1] != n - 1:
        found[count] = n - 1
        count += 1
    return found[:count].copy()


@kernel
def last_beyond(values: Floats, i: int, reach: float) -> int:
    """Return the last sample before i whose value differs by more than `reach`, else −1."""
    for j in range(i - 1, -1, -1):
        if abs(values[j] - values[i]) > reach:
            return j
    return -1
