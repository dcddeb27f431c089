"""Rows with the same time as the one before, merged into one."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable
from tsas_cli.support.arrays import Floats

How = Literal["first", "last", "mean"]


def merged(parts: Iterable[ColumnTable], time: ColumnSource, how: How) -> Iterator[ColumnTable]:
    """Yield the parts of a file with one row for each time, which may be repeated across parts.

    Parameters
    ----------
    time
        The source of the clock; rows of one time follow each other.
    how
        The row that stays, or the mean of each column, gaps left out.
    """
    held: ColumnTable | None = None  # the rows of the last time
    for part in parts:
        whole = part if held is None else _joined(held, part)
        begins = np.flatnonzero(np.diff(whole.columns[time], prepend=np.nan) != 0.0)
        if begins.size > 1:
            yield _one_each(_rows(whole, slice(0, int(begins[-1]))), begins[:-1], how)
        held = _rows(whole, slice(int(begins[-1]) if begins.size else 0, None))
    if held is not None:
        yield _one_each(held, np.zeros(1, dtype=np.intp), how)


def _joined(one: ColumnTable, other: ColumnTable) -> ColumnTable:
    columns = {s: np.concatenate([one.columns[s], v]) for s, v in other.columns.items()}
    numbers = np.concatenate([one.row_numbers, other.row_numbers])
    return replace(other, columns=columns, numbers=numbers)


def _rows(table: ColumnTable, rows: slice) -> ColumnTable:
    columns = {source: values[rows] for source, values in table.columns.items()}
    return replace(table, columns=columns, numbers=table.row_numbers[rows])


def _one_each(table: ColumnTable, begins: npt.NDArray[np.intp], how: How) -> ColumnTable:
    rows = table.row_numbers.size
    if not rows:
        return table
    chosen = begins if how != "last" else np.append(begins[1:], rows) - 1
    columns = {
        source: _means(values, begins) if how == "mean" else values[chosen]
        for source, values in table.columns.items()
    }
    return replace(table, columns=columns, numbers=table.row_numbers[chosen])


def _means(values: Floats, begins: npt.NDArray[np.intp]) -> Floats:
    finite = np.isfinite(values)
    counts = np.add.reduceat(finite.astype(np.float64), begins)
    sums = np.add.reduceat(np.where(finite, values, 0.0), begins)
    means: Floats = np.divide(sums, counts, out=np.full(counts.size, np.nan), where=counts > 0)
    return means
