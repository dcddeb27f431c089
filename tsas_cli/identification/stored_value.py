"""One number in `model.toml` or `drive.toml`."""

from typing import Literal

from pydantic import BaseModel, ConfigDict


class StoredValue(BaseModel):
    """A value as a file holds it, with its unit, what is known of it, and where it is from."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    value: float
    unit: str
    origin: Literal["fitted", "data sheet", "default"] = "data sheet"
    stderr: float | None = None
    interval_low: float | None = None
    interval_high: float | None = None
    at_bound: bool = False
