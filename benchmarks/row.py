"""One line of the table that the benchmarks print."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measured value with its unit, and the limits that are agreed for it, where there are."""

    name: str
    value: float
    unit: str
    at_most: float | None = None
    at_least: float | None = None

    @property
    def holds(self) -> bool | None:
        """Say whether the value keeps its limits; None where there are none."""
        if self.at_most is None and self.at_least is None:
            return None
        below = self.at_most is None or self.value <= self.at_most
        return below and (self.at_least is None or self.value >= self.at_least)
