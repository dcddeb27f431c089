"""One line of the table that the benchmarks print."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measured value with its unit, and what it must not exceed where that is agreed."""

    name: str
    value: float
    unit: str
    at_most: float | None = None

    @property
    def holds(self) -> bool | None:
        """Say whether the value keeps its limit; None where there is no limit."""
        return None if self.at_most is None else self.value <= self.at_most
