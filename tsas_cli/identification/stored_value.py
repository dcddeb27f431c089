"""One number in `model.toml` or `drive.toml`."""

from pydantic import BaseModel, ConfigDict

from tsas_cli.identification.estimate import Origin


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
