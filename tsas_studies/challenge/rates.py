"""A share of cases, with the interval that so few cases leave open."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

_QUANTILE = 1.959964  # of the normal distribution, 95 % two-sided


@dataclass(frozen=True)
class Rate:
    """`hits` of `cases`."""

    hits: int
    cases: int

    @property
    def share(self) -> float | None:
        """From 0 to 1; None where there is no case."""
        return self.hits / self.cases if self.cases else None

    def interval(self) -> tuple[float, float] | None:
        """Return the 95 % interval of the share by Wilson (1927); None where there is no case.

        It keeps its width at 0 and at 1, where the interval by the standard error has none.
        """
        if not self.cases:
            return None
        n, share, square = self.cases, self.hits / self.cases, _QUANTILE**2
        centre = (share + square / (2 * n)) / (1 + square / n)
        half = _QUANTILE * math.sqrt(share * (1 - share) / n + square / (4 * n**2))
        half /= 1 + square / n
        return max(0.0, centre - half), min(1.0, centre + half)


def rate(hits: Iterable[bool]) -> Rate:
    """Count what is true."""
    listed = list(hits)
    return Rate(sum(listed), len(listed))
