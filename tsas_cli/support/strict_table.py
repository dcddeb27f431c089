"""A table of a file that a person writes."""

from pydantic import BaseModel, ConfigDict


class StrictTable(BaseModel):
    """A table of TOML; an unknown key or a number that is not finite is refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
