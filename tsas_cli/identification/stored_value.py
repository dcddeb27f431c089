"""One number in `model.toml` or `drive.toml`."""

import math
from typing import Self

from pydantic import BaseModel, ConfigDict, model_validator

from tsas_cli.identification.estimate import Origin
from tsas_cli.records.base import check_interval


class StoredValue(BaseModel):
    """A value in a file, with its unit, its interval and its origin."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    value: float
    unit: str
    origin: Origin = "data sheet"
    stderr: float | None = None
    interval_low: float | None = None
    interval_high: float | None = None
    at_bound: bool = False

    @model_validator(mode="after")
    def _can_be_an_estimate(self) -> Self:
        if math.isfinite(self.value):  # else the number itself is refused
            check_interval(self.value, self.interval_low, self.interval_high)
        if self.stderr is not None and self.stderr < 0.0:
            raise ValueError(f"stderr {self.stderr:g} is below 0")
        return self
