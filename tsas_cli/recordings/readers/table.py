"""What every reader takes and returns: options, a table, its columns by their source in a map."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.strict_table import StrictTable, Texts

ColumnSource = str | int  # a column's name, or its number counted from 1

_IN_BRACKETS = re.compile(r"[\[(]([^\[\]()]+)[\])]$")
_INDEX = re.compile(r"[\d:,\s]*")
BATCH_ROWS = 1 << 20  # of a file that is read in parts, and of a row group of its run


class ReadOptions(StrictTable):
    """The table `[read]` of a map; every key is optional, and detected by default."""

    files: str = "*"  # of a folder, the files whose names match
    extra: tuple[ColumnSource, ...] = ()  # source columns that are kept unchanged
    drop_repeated_rows: bool = False
    repeated_times: Literal["first", "last", "mean"] | None = None  # what stays of their rows
    resample: bool = False  # interpolate channels with different times onto the fastest
    table: str | None = None  # the JSON key or the MATLAB variable that holds the table
    encoding: str = "utf-8-sig"
    skip_lines: int = Field(default=0, ge=0, le=1_000_000_000)
    comment: Texts = ("%", "#")
    delimiter: str | None = Field(default=None, min_length=1, max_length=1)
    decimal: Literal[".", ","] | None = None
    units_row: bool | None = None


@dataclass(frozen=True)
class ColumnTable:
    """The requested columns of one file, or of a part of its rows."""

    columns: Mapping[ColumnSource, Floats]  # by source, shape (n,); gaps are NaN
    units: Mapping[ColumnSource, str] = field(default_factory=dict)  # stated by the file
    header: tuple[str, ...] = ()  # the lines above the table, or other text of the file
    first_row: int = 1  # the number of the first row in the file, from 1
    typed: frozenset[ColumnSource] = frozenset()  # whose data type implies their unit
    numbers: npt.NDArray[np.int64] | None = None  # of the rows, if some of the file are left out

    @property
    def row_numbers(self) -> npt.NDArray[np.int64]:
        """The numbers of the rows in the file, shape (n,)."""
        if self.numbers is not None:
            return self.numbers
        rows = max((values.size for values in self.columns.values()), default=0)
        return np.arange(self.first_row, self.first_row + rows)


def resolve(
    wanted: Sequence[ColumnSource], names: Sequence[str], path: Path
) -> dict[ColumnSource, int]:
    """Return the index of each requested column among a file's columns.

    `wanted` are names, or numbers from 1; a column without a name is empty text in `names`.

    InputError: a column is missing, its name is not unique, or there are too many columns.
    """
    limits.columns(names, path)
    return {source: _index(source, names, path) for source in wanted}


def unit_in(name: str) -> str:
    """Return the unit in brackets at the end of a column's name, empty text without one.

    >>> [unit_in(name) for name in ("F [N]", "F (kN)", "effort[0]", "data(:,2)")]
    ['N', 'kN', '', '']
    """
    found = _IN_BRACKETS.search(name)
    return "" if found is None or _INDEX.fullmatch(found[1]) else found[1].strip()


def whole(parts: Iterable[ColumnTable]) -> ColumnTable:
    """Return the parts of one file as one table."""
    tables = list(parts)
    first = tables[0]
    if len(tables) == 1:
        return first
    columns = {s: np.concatenate([t.columns[s] for t in tables]) for s in first.columns}
    numbers = np.concatenate([table.row_numbers for table in tables])
    return replace(first, columns=columns, numbers=numbers)


def floats(values: Any, source: ColumnSource, path: Path, *, first: int = 1) -> Floats:
    """Return values as float64; null becomes NaN. `first` is the number of the first row.

    InputError: a value is not numeric, or the values are complex, dates or durations.
    """
    # NumPy would drop the imaginary part or the unit.
    if isinstance(values, np.ndarray) and values.dtype.kind in "cmM":
        raise InputError(
            f"column {source} holds {values.dtype}", where=path, expected="real numbers"
        )
    try:
        of_numbers = isinstance(values, np.ndarray) and values.dtype.kind in "fiub"
        has_text = not of_numbers and any(isinstance(value, str | bytes) for value in values)
        numbers = None if has_text else np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        numbers = None
    if numbers is None:
        numbers = np.array([_number(v, source, path, i) for i, v in enumerate(values, first)])
    if numbers.ndim != 1:
        raise InputError(f"column {source} has {numbers.ndim} dimensions", where=path, expected="1")
    return numbers


def not_a_number(found: object, source: ColumnSource, path: Path, row: int) -> InputError:
    """Return the error for a cell that is no number."""
    return InputError(
        f"column {source} holds {str(found)[:40]!r}",
        where=f"{path}, row {row}",
        expected="a number, or an empty cell for a gap",
    )


def _number(value: Any, source: ColumnSource, path: Path, row: int) -> float:
    if isinstance(value, str | bytes) and "_" in str(value):  # Python reads 1_2 as 12
        raise not_a_number(value, source, path, row)
    try:
        return float("nan") if value is None else float(value)
    except (TypeError, ValueError, OverflowError):
        raise not_a_number(value, source, path, row) from None


def _index(source: ColumnSource, names: Sequence[str], path: Path) -> int:
    if isinstance(source, int):
        if 1 <= source <= len(names):
            return source - 1
        raise InputError(f"column {source} is missing", where=path, remedy=_listed(names))
    found = [i for i, name in enumerate(names) if name == source]
    if len(found) == 1:
        return found[0]
    if found:
        numbers = ", ".join(str(i + 1) for i in found)
        raise InputError(
            f"{len(found)} columns have the name {source}",
            where=path,
            remedy=f"map one of them by its number: {numbers}",
        )
    close = nearest(source, (n for n in names if n))
    hint = f"{close}; " if close.startswith("did") else ""
    raise InputError(f"column {source} is missing", where=path, remedy=hint + _listed(names))


def _listed(names: Sequence[str]) -> str:
    if not names:
        return "there are no columns of numbers"
    if not any(names):
        return f"there are {len(names)} columns without names: map them by number, from 1"
    shown = [name[:80] or f"{i + 1} (a number: it has no name)" for i, name in enumerate(names)]
    more = f" and {len(shown) - 40} more" if len(shown) > 40 else ""
    return f"there are: {', '.join(shown[:40])}{more}"


def optional(module: str, *, extra: str) -> ModuleType:
    """Import a package that comes with an extra of tsas; InputError: it is not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        raise InputError(
            f"this file format needs the package {module.partition('.')[0]}",
            remedy=f"python -m pip install 'tsas[{extra}]'",
        ) from error
