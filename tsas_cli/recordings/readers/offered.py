"""What most readers give: the columns that a file offers, each loaded when it is requested."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, is_dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.guards import Expanded, foreign
from tsas_cli.recordings.readers.table import (
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    resolve,
    unit_in,
)
from tsas_cli.recordings.readers.timebase import TIME, Seconds, is_stamp, on_one_clock
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

A_TIME_IN = "a time in "
_MOST_ITEMS = 64  # of a list, whose items become columns; longer ones are images or scans


@dataclass(frozen=True)
class Column:
    """One column of a file, whose values and times are loaded when they are requested."""

    name: str  # empty text for a column without one
    values: Callable[[], Any]  # shape (n,)
    unit: str = ""  # stated by the file, or empty
    times: Callable[[], Floats] | None = None  # its own clock, (n,); None in a file of one table
    clock: str = f"{A_TIME_IN}s"  # what its clock is, and in which unit


@dataclass(frozen=True)
class Offered:
    """The columns of a file in order, and its text."""

    columns: Sequence[Column]
    header: tuple[str, ...] = ()

    @property
    def names(self) -> list[str]:
        """The names of the columns; where they have clocks of their own, `time` is the last."""
        clocked = any(column.times for column in self.columns)
        return [*(column.name for column in self.columns), *([TIME] if clocked else [])]


def names(path: Path, module: str, kind: str, options: ReadOptions) -> list[str]:
    """Return the names of a file's columns; `module` has a generator `offered` for its format.

    InputError: the file is damaged, or the package for its format is not installed.
    """
    with _opened(path, module, kind, options) as offered:
        return offered.names


def read(
    path: Path, module: str, kind: str, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> ColumnTable:
    """Return the requested columns of a file.

    Dates become seconds since the first one of their column, durations become seconds.

    InputError: as from `names`; or a column is missing or not numeric, the columns hold more than a
    file of this size can, their clocks differ and `resample` is not set, or a clock is no time.
    """
    with _opened(path, module, kind, options) as offered:
        at = resolve(wanted, offered.names, path)
        expanded = Expanded.of(path)
        columns, times = dict[ColumnSource, Floats](), dict[ColumnSource, Floats]()
        typed: set[ColumnSource] = set()
        found = {s: offered.columns[i] for s, i in at.items() if i < len(offered.columns)}
        clocks = [source for source, i in at.items() if i == len(offered.columns)]
        clock_unit = _clock_unit(found.values(), path, is_requested=bool(clocks))
        for source, column in found.items():
            values = column.values()
            expanded.add(8 * len(values), what=f"{len(values)} rows")
            columns[source], is_time = _numbers(values, source, path)
            typed |= {source} if is_time else set()
            if column.times is not None:
                times[source] = column.times()
        if times or clocks:
            series = {s: (_clock_of(s, times, columns, path), columns[s]) for s in columns}
            columns = on_one_clock(series, path, clock_sources=clocks, resample=options.resample)
        named = {s: column.unit or unit_in(column.name) for s, column in found.items()}
        units = {s: unit for s, unit in named.items() if unit}
        units |= dict.fromkeys(typed, "s") | dict.fromkeys(clocks, clock_unit)
        return ColumnTable(columns, units, offered.header, typed=frozenset(typed))


@contextmanager
def _opened(path: Path, module: str, kind: str, options: ReadOptions) -> Iterator[Offered]:
    with foreign(path, kind):
        yield from import_module(module).offered(path, options)


def _clock_unit(columns: Iterable[Column], path: Path, *, is_requested: bool) -> str:
    """Return the unit of the columns' clocks, which have to be times if one is requested."""
    clocks = list(dict.fromkeys(column.clock for column in columns)) or [Column.clock]
    if len(clocks) > 1 or (is_requested and not clocks[0].startswith(A_TIME_IN)):
        raise InputError(
            f"the clock of the channels is {', '.join(clocks)}",
            where=path,
            expected="a time, in one unit",
            remedy="map channels of one group; one without a time needs rate_Hz in the map",
        )
    return clocks[0].removeprefix(A_TIME_IN)


def _clock_of(
    source: ColumnSource,
    times: Mapping[ColumnSource, Floats],
    columns: Mapping[ColumnSource, Floats],
    path: Path,
) -> Floats:
    """Return the clock of a column, or one of as many samples for a column without one."""
    found = [times[source]] if source in times else list(times.values())
    fitting = [clock for clock in found if clock.size == columns[source].size]
    if not fitting:
        raise InputError(
            f"{source} has {columns[source].size} samples and no clock of that length", where=path
        )
    return fitting[0]


def _numbers(values: Any, source: ColumnSource, path: Path) -> tuple[Floats, bool]:
    """Return values as float64, and whether they are dates or durations in seconds."""
    if isinstance(values, np.ndarray) and values.dtype.kind in "mM":
        return Seconds()(values), True
    if not isinstance(values, np.ndarray) and is_stamp(next(filter(None, values), None)):
        try:
            return Seconds().from_text(values), True
        except ValueError as error:
            raise InputError(
                f"column {source} holds dates or times of several forms",
                where=path,
                expected="2026-03-03T14:05:06.7 or 14:05:06.7 in all rows",
            ) from error
    return floats(values, source, path), False


def flat(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of a record by their paths: `pose.position.x`, `effort[0]`."""
    for key, value in record.items():
        yield from _named(f"{prefix}{key}", value)


def _named(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if is_dataclass(value):
        value = vars(value)
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.size <= _MOST_ITEMS else []
    if isinstance(value, Mapping):
        yield from flat(value, f"{name}.")
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        for i, item in enumerate(value if len(value) <= _MOST_ITEMS else ()):
            yield from _named(f"{name}[{i}]", item)
    else:
        yield name, value


def columns_in(
    name: str, array: Any, unit: str = "", load: Callable[[Any], npt.NDArray[Any]] | None = None
) -> list[Column]:
    """Return the columns of numbers or of times in an array.

    A vector is a column, the field of records `name.field`, the j-th column of a matrix
    `name(:,j)`; samples lie along its longer side. Other arrays hold none.

    `array` has `shape`, `ndim` and `dtype`; `load` loads its values, which are there without it.
    """
    whole = partial(load, array) if load else partial(np.asarray, array)
    if array.ndim not in {1, 2} or (array.size < 2 and array.ndim == 2):
        return []
    if array.dtype.names:
        return [
            Column(f"{name}.{field}" if name else field, partial(lambda f: whole()[f], field), unit)
            for field in array.dtype.names
            if array.dtype[field].kind in "fiubmM" and array.ndim == 1
        ]
    if array.dtype.kind not in "fiubmM":
        return []
    if 1 in array.shape or array.ndim == 1:
        return [Column(name, lambda: whole().ravel(), unit)]
    axis = 0 if array.shape[0] < array.shape[1] else 1
    return [
        Column(
            f"{name}(:,{j + 1})" if name else "",
            partial(lambda j: np.take(whole(), j, axis), j),
            unit,
        )
        for j in range(min(array.shape))
    ]
