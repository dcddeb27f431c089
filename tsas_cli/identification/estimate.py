"""An estimate: value, interval, unit, bound flag, origin."""

from dataclasses import dataclass
from typing import Literal, Self

from pydantic import model_validator

from tsas_cli.records.base import check_interval, value_text
from tsas_cli.support.errors import InputError
from tsas_cli.support.plausible import AnyNumber, Range, StandardError
from tsas_cli.support.strict_table import StrictTable

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

    def holds(self, *values: float) -> bool:
        """Return whether there is an interval, and each of some values lies in it."""
        low, high = self.interval_low, self.interval_high
        return low is not None and high is not None and all(low <= v <= high for v in values)


class StoredValue(StrictTable):
    """A value in a file, with its unit, its interval and its origin."""

    value: float
    unit: str
    origin: Origin = "data sheet"
    stderr: StandardError | None = None
    interval_low: AnyNumber | None = None
    interval_high: AnyNumber | None = None
    at_bound: bool = False

    @model_validator(mode="after")
    def _can_be_an_estimate(self) -> Self:
        check_interval(self.value, self.interval_low, self.interval_high)
        return self


def check_value(name: str, value: StoredValue, allowed: Range, where: object) -> None:
    """Refuse a value in another unit than that of its range, or outside of it: InputError."""
    if value.unit != allowed.unit:
        raise InputError(
            f"{name} is in {value.unit!r}", where=where, expected=f"the unit {allowed.unit!r}"
        )
    if value.value not in allowed:
        shown = "" if allowed.unit == "1" else f" {allowed.unit}"
        raise InputError(f"{name} is {value.value:g}{shown}", where=where, expected=str(allowed))
