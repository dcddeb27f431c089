"""How long repeats of one piece of work take, for every benchmark that times a function."""

import statistics
import timeit
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Times:
    """Repeats of one piece of work [s]."""

    seconds: tuple[float, ...]

    @property
    def least(self) -> float:
        """The time of the fastest repeat: what else ran on the machine only adds to it."""
        return min(self.seconds)

    @property
    def median(self) -> float:
        """The time that half of the repeats need at most."""
        return statistics.median(self.seconds)

    @property
    def largest(self) -> float:
        """The time of the slowest repeat."""
        return max(self.seconds)


def times(solve: Callable[[], object], repeats: int) -> Times:
    """Return the times of repeats; the first call compiles and does not count."""
    solve()
    return Times(tuple(timeit.repeat(solve, number=1, repeat=repeats)))


def best(solve: Callable[[], object], repeats: int) -> float:
    """Return the time of the fastest repeat [s]; the first call compiles and does not count."""
    return times(solve, repeats).least
