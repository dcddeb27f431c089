"""The map of `tsas ingest`: what a person says about the files of a rig."""

from collections.abc import Iterator
from pathlib import Path
from re import Pattern
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from tsas_cli.recordings.columns import NAMES, TIME, has_input_and_output
from tsas_cli.recordings.manifest import Load, Rig, parse, read_toml
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw

QUESTION = "?"  # in place of a value: what a guessed map leaves to a person
Condition = Literal["preload_N", "sheath_length_mm", "total_bend_rad"]


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class DatasetWords(_Strict):
    """`[dataset]`: what goes into the manifest as it is."""

    name: str
    kind: Literal["measured", "simulated"] = "measured"
    description: str = ""
    license: str | None = None
    source: str | None = None


class MapRig(Rig):
    """`[rig]`: the keys of the manifest, and no others."""

    model_config = ConfigDict(extra="forbid")


class ColumnMap(_Strict):
    """`[columns.NAME]`: value = sign · (source in the canonical unit) − offset."""

    source: Source = ""
    rate_Hz: float | None = Field(default=None, gt=0)  # time_s of files without a clock
    unit: str | None = None
    factor: float | None = None
    factor_unit: str | None = None
    pulley_radius_mm: float | None = Field(default=None, gt=0)
    sign: Literal[1, -1] = 1
    offset: float | Literal["first"] = 0.0  # in the canonical unit; "first": the first sample

    @model_validator(mode="after")
    def _is_whole(self) -> "ColumnMap":
        if (self.source == "") == (self.rate_Hz is None):
            raise ValueError("needs a source (time_s may have rate_Hz instead)")
        if (self.factor is None) != (self.factor_unit is None):
            raise ValueError("factor and factor_unit belong together")
        return self


class FromText(_Strict):
    """`[run.from_file_name]`, `[run.from_header]`: named groups become conditions."""

    pattern: Pattern[str]


class Converted(_Strict):
    """`[run.conditions.NAME]`: a named group that is in another unit."""

    group: str = Field(alias="from")
    unit: str


class RunMap(_Strict):
    """`[run]`: the conditions of the runs, later ones over earlier ones."""

    id: str = "{stem}"
    load: Load = "spring"
    preload_N: float | None = None
    sheath_length_mm: float | None = None
    total_bend_rad: float | None = None
    from_file_name: FromText | None = None
    from_header: FromText | None = None
    conditions: dict[Condition, Converted] = {}
    table: dict[str, Raw] = {}


class IngestMap(_Strict):
    """The whole map."""

    dataset: DatasetWords
    rig: MapRig = MapRig()
    read: ReadOptions = ReadOptions()
    columns: dict[str, ColumnMap]
    run: RunMap = RunMap()

    @field_validator("columns")
    @classmethod
    def _are_a_recording(cls, columns: dict[str, ColumnMap]) -> dict[str, ColumnMap]:
        for name, column in columns.items():
            if name not in NAMES:
                raise ValueError(f"unknown column {name} ({nearest(name, NAMES)})")
            if column.rate_Hz is not None and name != TIME:
                raise ValueError(f"{name} cannot have rate_Hz, only {TIME} can")
        if TIME not in columns:
            raise ValueError(f"{TIME} is missing: map the clock, or say its rate_Hz")
        if not has_input_and_output(frozenset(columns)):
            raise ValueError("an input and an output column are needed, such as x_in_mm and f_in_N")
        return columns

    def sources(self) -> list[Source]:
        """Return every source column that the map takes, each once."""
        mapped = [column.source for column in self.columns.values() if column.rate_Hz is None]
        return list(dict.fromkeys([*mapped, *self.read.extra]))


def read_map(path: Path) -> IngestMap:
    """Read a map.

    Raises
    ------
    InputError
        It is missing, is not TOML, says something that a map cannot say, or still asks.
    """
    content = read_toml(path)
    asked = list(_questions(content))
    if asked:
        raise InputError(
            f"{len(asked)} question{'s are' if len(asked) > 1 else ' is'} open: {', '.join(asked)}",
            where=path,
            expected=f'an answer in place of "{QUESTION}"',
            remedy="the comment above each says what is known; a channel that is not there goes",
        )
    return parse(IngestMap, content, path)


def _questions(content: Any, key: str = "") -> Iterator[str]:
    """Yield the keys whose values are questions."""
    if content == QUESTION:
        yield key
    elif isinstance(content, dict):
        for name, value in content.items():
            yield from _questions(value, f"{key}.{name}" if key else name)
