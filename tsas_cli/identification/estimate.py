"""An estimate: value, interval, unit, bound flag, origin."""

from dataclasses import dataclass
from typing import Literal

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
