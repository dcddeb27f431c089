"""A fixed piece of work, timed beside each benchmark: what its times are counted in.

Times of two machines, or of one that was busy, cannot be compared; how many times as long as the
same work in the same run can. It is a third each of what this project's time goes into: the
interpreter, compiled loops whose steps wait for each other, and arrays beyond the caches.
"""

import math

import numba
import numpy as np

from benchmarks.timing import Times, times

VERSION = 1  # of the work: files with another one are not compared
REPEATS = 15
LOOPS, STEPS, NUMBERS = 150_000, 400_000, 2_000_000  # each about 7 ms on a machine of 2024


@numba.njit  # type: ignore[untyped-decorator]
def compiled(steps: int) -> float:
    """Return a sum whose terms depend on each other."""
    total = 0.5
    for step in range(steps):
        total += math.exp(-total) / (1.0 + step)
    return total


def yardstick() -> Times:
    """Return how long the work takes."""
    array = np.linspace(0.0, 1.0, NUMBERS)

    def work() -> None:
        seen: dict[int, int] = {}
        for k in range(LOOPS):
            seen[k % 100] = k
        compiled(STEPS)
        np.cumsum(array)

    return times(work, REPEATS)
