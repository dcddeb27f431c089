"""One line of the table that the benchmarks print."""

from dataclasses import dataclass
from typing import Literal

from benchmarks.timing import Times

Kind = Literal["time", "rate", "cost", "gain", "figure"]

TIMES = ("s", "ms", "µs", "ns")
RATES = ("MB/s", "GB/s", "rows/s", "1/s")


@dataclass(frozen=True)
class Row:
    """A measured value with its unit, and the limits that are agreed for it, where there are."""

    name: str
    value: float
    unit: str
    at_most: float | None = None
    at_least: float | None = None
    # How two runs are compared. A `time` and a `rate` count in units of the yardstick of their run.
    # A `cost` (less is better) and a `gain` (more is better) are ratios within one run already,
    # such as over a peer. A `figure` is no speed: a size, a share, a count. Where it is not said,
    # the unit tells, and the limit of a number without one.
    kind: Kind | None = None
    # The least, the median and the largest of the repeats, in the row's unit; None where it was
    # measured once.
    spread: tuple[float, float, float] | None = None

    @classmethod
    def timed(
        cls,
        name: str,
        times: Times,
        unit: str,
        *,
        per_s: float = 1.0,
        at_most: float | None = None,
    ) -> "Row":
        """Return the time of the fastest repeat; `per_s` of the unit are one second."""
        low, middle, high = (per_s * t for t in (times.least, times.median, times.largest))
        return cls(name, low, unit, at_most, spread=(low, middle, high))

    @property
    def compared_as(self) -> Kind:
        """Return how two runs are compared."""
        if self.kind is not None:
            return self.kind
        if self.unit in TIMES or self.unit in RATES:
            return "time" if self.unit in TIMES else "rate"
        if self.unit:
            return "figure"
        return "gain" if self.at_least else "cost" if self.at_most else "figure"

    @property
    def holds(self) -> bool | None:
        """Say whether the value keeps its limits; None where there are none."""
        if self.at_most is None and self.at_least is None:
            return None
        below = self.at_most is None or self.value <= self.at_most
        return below and (self.at_least is None or self.value >= self.at_least)
