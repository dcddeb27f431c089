"""What most readers give: the columns that a file offers, each loaded when it is requested."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.recordings.readers.stamps import Seconds, is_stamp
from tsas_cli.recordings.readers.table import (
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    resolve,
)
from tsas_cli.recordings.readers.timebase import TIME, on_one_clock
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.memory import out_of_memory


@dataclass(frozen=True)
class Column:
    """One column of a file.

    Attributes
    ----------
    name
        Empty text for a column without one.
    values
        Loads its values, shape (n,).
    unit
        The unit stated by the file, or empty.
    times
        Loads its own clock [s], shape (n,); None in a file whose columns are rows of one table.
    """

    name: str
    values: Callable[[], Any]
    unit: str = ""
    times: Callable[[], Floats] | None = None


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
    """Return the names of a file's columns; `module` has a function `offered` for its format.

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
    file of this size can, or their clocks differ and `resample` is not set.
    """
    with _opened(path, module, kind, options) as offered:
        at = resolve(wanted, offered.names, path)
        expanded = Expanded.of(path)
        columns, times = dict[ColumnSource, Floats](), dict[ColumnSource, Floats]()
        typed: set[ColumnSource] = set()
        found = {s: offered.columns[i] for s, i in at.items() if i < len(offered.columns)}
        for source, column in found.items():
            values = column.values()
            expanded.add(8 * len(values), what=f"{len(values)} rows")
            columns[source], is_time = _numbers(values, source, path)
            typed |= {source} if is_time else set()
            if column.times is not None:
                times[source] = column.times()
        clocks = [source for source, i in at.items() if i == len(offered.columns)]
        if times or clocks:
            series = {s: (_clock_of(s, times, columns, path), columns[s]) for s in columns}
            columns = on_one_clock(series, path, clock_sources=clocks, resample=options.resample)
        units = {s: column.unit for s, column in found.items() if column.unit}
        units |= dict.fromkeys([*typed, *clocks], "s")
        return ColumnTable(columns, units, offered.header, typed=frozenset(typed))


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


@contextmanager
def _opened(path: Path, module: str, kind: str, options: ReadOptions) -> Iterator[Offered]:
    try:
        with import_module(module).offered(path, options) as offered:
            yield offered
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except Exception as error:  # a damaged file raises any of a dozen types
        raise damaged(path, kind, error) from error
