"""The map of `tsas ingest`: how the columns of raw files become those of a dataset."""

from collections.abc import Iterator
from pathlib import Path
from re import Pattern
from typing import Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from tsas_cli.recordings.columns import NAMES, TIME, has_input_and_output
from tsas_cli.recordings.manifest import Load, RigSheet, parse, read_toml
from tsas_cli.recordings.readers.table import ColumnSource, ReadOptions
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw
from tsas_cli.support.plausible import AnyNumber, Bend, Length, Preload, Radius, SampleRate
from tsas_cli.support.strict_table import StrictTable

QUESTION = "?"  # in place of a value that a guessed map leaves open
_Condition = Literal["preload_N", "sheath_length_mm", "total_bend_rad"]


class DatasetEntry(StrictTable):
    """`[dataset]`: keys that are copied into the manifest."""

    name: str
    kind: Literal["measured", "simulated"] = "measured"
    description: str = ""
    license: str | None = None
    source: str | None = None


class MapRig(RigSheet):
    """`[rig]`: the keys of the manifest's `[rig]`, and no others."""

    model_config = ConfigDict(extra="forbid")


class ColumnMap(StrictTable):
    """`[columns.NAME]`: value = sign · (source in the canonical unit) − offset."""

    source: ColumnSource = ""
    rate_Hz: SampleRate | None = None  # time_s of files without a clock
    unit: str | None = None
    factor: AnyNumber | None = None
    factor_unit: str | None = None
    pulley_radius_mm: Radius | None = None
    sign: Literal[1, -1] = 1
    offset: AnyNumber | Literal["first"] = 0.0  # in the canonical unit; "first": the first sample

    @model_validator(mode="after")
    def _is_whole(self) -> "ColumnMap":
        if (self.source == "") == (self.rate_Hz is None):
            raise ValueError("needs a source (time_s may have rate_Hz instead)")
        if (self.factor is None) != (self.factor_unit is None):
            raise ValueError("factor and factor_unit belong together")
        return self


class FromText(StrictTable):
    """`[run.from_file_name]`, `[run.from_header]`: named groups become conditions."""

    pattern: Pattern[str]


class Converted(StrictTable):
    """`[run.conditions.NAME]`: a named group in a unit of its own."""

    group: str = Field(alias="from")
    unit: str


class RunMap(StrictTable):
    """`[run]`: the conditions of the runs; later sources take precedence."""

    id: str = "{stem}"
    load: Load = "spring"
    preload_N: Preload | None = None
    sheath_length_mm: Length | None = None
    total_bend_rad: Bend | None = None
    from_file_name: FromText | None = None
    from_header: FromText | None = None
    conditions: dict[_Condition, Converted] = Field(default_factory=dict)
    table: dict[str, Raw] = Field(default_factory=dict)


class IngestMap(StrictTable):
    """The whole map."""

    dataset: DatasetEntry
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
            raise ValueError(f"{TIME} is missing: map the clock, or set its rate_Hz")
        if not has_input_and_output(frozenset(columns)):
            raise ValueError("an input and an output column are needed, such as x_in_mm and f_in_N")
        return columns

    def sources(self) -> list[ColumnSource]:
        """Return the distinct source columns of the map."""
        mapped = [column.source for column in self.columns.values() if column.rate_Hz is None]
        return list(dict.fromkeys([*mapped, *self.read.extra]))


def read_map(path: Path) -> IngestMap:
    """Return a validated map.

    InputError: the file is missing, is not TOML, is no valid map, or has open questions.
    """
    content = read_toml(path)
    open_keys = list(_questions(content))
    if open_keys:
        raise InputError(
            f"{len(open_keys)} question{'s are' if len(open_keys) > 1 else ' is'} open: "
            f"{', '.join(open_keys)}",
            where=path,
            expected=f'a value in place of "{QUESTION}"',
            remedy="see the comment above each; remove the table of a channel without a column",
        )
    return parse(IngestMap, content, path)


def _questions(content: Any, key: str = "") -> Iterator[str]:
    """Yield the keys whose value is `QUESTION`."""
    if content == QUESTION:
        yield key
    elif isinstance(content, dict):
        for name, value in content.items():
            yield from _questions(value, f"{key}.{name}" if key else name)
