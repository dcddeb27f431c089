"""One number in `model.toml` or `drive.toml`."""

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from tsas_cli.identification.estimate import Origin
from tsas_cli.records.base import check_interval


class StoredValue(BaseModel):
    """A value in a file, with its unit, its interval and its origin."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    value: float
    unit: str
    origin: Origin = "data sheet"
    stderr: float | None = Field(default=None, ge=0)
    interval_low: float | None = None
    interval_high: float | None = None
    at_bound: bool = False

    @model_validator(mode="after")
    def _can_be_an_estimate(self) -> Self:
        check_interval(self.value, self.interval_low, self.interval_high)
        return self
