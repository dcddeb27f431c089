"""An estimate: value, interval, unit, bound flag, origin."""

from dataclasses import dataclass
from typing import Literal

from tsas_cli.records.base import value_text

Origin = Literal["fitted", "data sheet", "default", "given"]


@dataclass(frozen=True)
class Estimate:
    """One parameter; the interval is of 95 % confidence, None where none was estimated."""

    name: str
    value: float
    unit: str
    origin: Origin
    run: str | None = None
    stderr: float | None = None
    interval_low: float | None = None
    interval_high: float | None = None
    at_bound: bool = False

    def text(self) -> str:
        """Return value and interval for a printed table; where there is none, its origin."""
        ends = self.interval_low, self.interval_high
        return value_text(self.value, ends, at_bound=self.at_bound, origin=self.origin)
