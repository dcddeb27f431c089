"""An estimate: value, interval, unit, bound flag, origin."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

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

    def as_json(self) -> dict[str, Any]:
        """Return the estimate as written by the stages."""
        return asdict(self)

    def text(self) -> str:
        """Return value and interval for a printed table."""
        if self.interval_low is None or self.interval_high is None:
            return f"{self.value:.5g} ({self.origin})"
        flag = "  AT BOUND" if self.at_bound else ""
        return f"{self.value:.5g} [{self.interval_low:.5g}, {self.interval_high:.5g}]{flag}"
