"""The map of `tsas ingest`: how raw files become a dataset, and the conditions of a run by it."""

import re
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from re import Pattern
from types import FrameType
from typing import Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from tsas_cli.recordings.columns import NAMES, TIME, has_input_and_output
from tsas_cli.recordings.manifest import Load, RigSheet, check_run_name, read_toml
from tsas_cli.recordings.readers import stem
from tsas_cli.recordings.readers.layout import may_be_thousands
from tsas_cli.recordings.readers.table import ColumnSource, ReadOptions
from tsas_cli.recordings.units import conversion
from tsas_cli.recordings.validation import parse
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw
from tsas_cli.support.plausible import AnyNumber, Bend, Length, Preload, Radius, SampleRate
from tsas_cli.support.strict_table import StrictTable

SEARCH_TIMEOUT_S = 10.0  # of a pattern, whose search may take exponential time
_UNITS = {"preload_N": "N", "sheath_length_mm": "mm", "total_bend_rad": "rad"}
QUESTION = "?"  # in place of a value that a guessed map leaves open
_OF_TWO_ENDS = (("x_in_mm", "x_out_mm"), ("f_in_N", "f_out_N"))
_Condition = Literal["preload_N", "sheath_length_mm", "total_bend_rad"]


class DatasetEntry(StrictTable):
    """`[dataset]`: keys that are copied into the manifest."""

    name: str = Field(min_length=1)
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
        if self.source == "" and self.rate_Hz is None:
            raise ValueError("needs a source (time_s may have rate_Hz instead)")
        if self.source != "" and self.rate_Hz is not None:
            raise ValueError("has a source and rate_Hz: only one of them may be given")
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
        for pair in _OF_TWO_ENDS:
            both = [columns[name].source for name in pair if name in columns]
            if len(both) > len(set(both)):
                raise ValueError(f"{' and '.join(pair)} have one source, {both[0]!r}")
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
    if content == QUESTION:
        yield key
    elif isinstance(content, dict):
        for name, value in content.items():
            yield from _questions(value, f"{key}.{name}" if key else name)


def run_conditions(
    path: Path, header: Sequence[str], run_map: RunMap, decimal: str | None = None
) -> Raw:
    """Return a run's id, its conditions and the other named groups of its file name and header.

    Later sources take precedence: `[run]`, the file name (with its folder), the header, the
    converted groups, the table entry of the run's id. A comma is a decimal mark; an ambiguous one
    (1,250 may be thousands) needs `decimal`.

    InputError: a pattern does not match, a group is missing, no number or ambiguous by a factor of
    1000, or a unit does not fit.
    """
    folder = path.absolute().parent.name
    groups = _groups(run_map.from_file_name, f"{folder}/{path.name}", path)
    groups |= _groups(run_map.from_header, "\n".join(header), path)
    for key, text in groups.items():
        if decimal != "," and may_be_thousands(text):
            raise InputError(
                f"group {key} is {text}: is the comma a decimal mark or a thousands separator?",
                where=path,
                remedy='set decimal = "," under [read] of the map, or the value itself under [run]',
            )
    words = {"stem": stem(path), "folder": folder} | groups
    for word in re.findall(r"\{(\w+)\}", run_map.id):
        if word not in words:
            hint = nearest(word, words)
            raise InputError(f"run.id: {{{word}}} is unknown", remedy=hint)
    name = re.sub(r"\{(\w+)\}", lambda word: words[word[1]], run_map.id)
    try:
        check_run_name(name)
    except ValueError as error:
        raise InputError(
            f"run id {name!r} {error}",
            where=path,
            remedy='set another in the map, such as id = "run_{stem}" under [run]',
        ) from error
    converted = {
        condition: _converted(condition, rule, groups, path)
        for condition, rule in run_map.conditions.items()
    }
    used = {rule.group for rule in run_map.conditions.values()}
    direct = {
        key: text if key == "started" else _plain(text)  # 20260302 is a date, no number
        for key, text in groups.items()
        if key not in used
    }
    defaults = run_map.model_dump(include={"load", *_UNITS}, exclude_none=True)
    return defaults | direct | converted | run_map.table.get(name, {}) | {"id": name}


def _converted(condition: str, rule: Converted, groups: dict[str, str], path: Path) -> float:
    if rule.group not in groups:
        hint = nearest(rule.group, groups)
        raise InputError(f"no group {rule.group} for {condition}", where=path, remedy=hint)
    value = _plain(groups[rule.group])
    if isinstance(value, str):
        raise InputError(f"group {rule.group} is {value!r}", where=path, expected="a number")
    where = f"run.conditions.{condition} of the map"
    slope, intercept = conversion(rule.unit, _UNITS[condition], where=where)
    return slope * value + intercept


def _groups(rule: FromText | None, text: str, path: Path) -> dict[str, str]:
    if rule is None:
        return {}
    shown = text if len(text) <= 60 else f"{text[:60]}…"
    try:
        with at_most(SEARCH_TIMEOUT_S):
            found = rule.pattern.search(text)
    except TimeoutError as error:
        raise InputError(
            f"the pattern {rule.pattern.pattern!r} has not finished searching {shown!r} "
            f"after {SEARCH_TIMEOUT_S:g} s",
            where=path,
            remedy="nested repetitions, such as (a+)+, take exponential time: simplify it",
        ) from error
    if found is None:
        raise InputError(
            f"the pattern {rule.pattern.pattern!r} does not match {shown!r}", where=path
        )
    return {key: value for key, value in found.groupdict().items() if value is not None}


def _plain(text: str) -> float | int | str:
    """Return text as a number where it is one, else unchanged."""
    for kind in (int, float) if "_" not in text else ():  # Python reads 1_2 as 12
        try:
            return kind(text.replace(",", "."))
        except ValueError:
            continue
    return text


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Run the block with a time limit; without one outside the main thread.

    TimeoutError: the block took longer.
    """

    def late(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise TimeoutError

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
