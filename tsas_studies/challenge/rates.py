"""A share of cases, with the interval that so few cases leave open."""

from collections.abc import Iterable
from dataclasses import dataclass

from scipy.stats import binomtest


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
        found = binomtest(self.hits, self.cases).proportion_ci(method="wilson")
        return float(found.low), float(found.high)


def rate(hits: Iterable[bool]) -> Rate:
    """Count what is true."""
    listed = list(hits)
    return Rate(sum(listed), len(listed))
