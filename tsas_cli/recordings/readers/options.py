"""Options of a map for reading its files."""

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from tsas_cli.recordings.readers.table import ColumnSource


def _as_list(value: object) -> object:
    return [value] if isinstance(value, str) else value


class ReadOptions(BaseModel):
    """The table `[read]` of a map; every key is optional, and detected by default."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    files: str = "*"  # of a folder, the files whose names match
    extra: tuple[ColumnSource, ...] = ()  # source columns that are kept unchanged
    drop_repeated_rows: bool = False
    resample: bool = False  # interpolate channels with different times onto the fastest
    table: str | None = None  # the JSON key or the MATLAB variable that holds the table
    encoding: str = "utf-8-sig"
    skip_lines: int = Field(default=0, ge=0)
    comment: Annotated[tuple[str, ...], BeforeValidator(_as_list)] = ("%", "#")
    delimiter: str | None = Field(default=None, min_length=1, max_length=1)
    decimal: Literal[".", ","] | None = None
    units_row: bool | None = None
