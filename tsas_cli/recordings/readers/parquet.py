"""Parquet files."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from tsas_cli.recordings.parquet_files import check_size, open_parquet, reading
from tsas_cli.recordings.readers.table import (
    BATCH_ROWS,
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    in_batches,
    resolve,
)
from tsas_cli.support.arrays import Floats


def batches(
    path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> Iterator[ColumnTable]:
    """Yield the requested columns of a Parquet file in parts; units from field metadata `unit`.

    Dates become seconds since the first one in their column, durations become seconds.

    Raises
    ------
    InputError
        The file is damaged, or a column is missing or not numeric.
    """
    del options
    with reading(path), open_parquet(path) as file:
        schema = file.schema_arrow
        at = resolve(wanted, schema.names, path)
        fields = {source: schema.field(i) for source, i in at.items()}
        units = {
            s: f.metadata[b"unit"].decode(errors="replace")
            for s, f in fields.items()
            if b"unit" in (f.metadata or {})
        }
        names = [field.name for field in fields.values()]
        check_size(file, path, names, whole=False)
        # A duplicate name is read twice: `order` is the number among columns of that name.
        order = {s: schema.get_all_field_indices(schema.names[i]).index(i) for s, i in at.items()}
        zeros: dict[ColumnSource, Any] = {}
        first = 1
        for table in in_batches(file.iter_batches(BATCH_ROWS, columns=names)):
            values = {
                source: _values(table, field.name, order[source])
                for source, field in fields.items()
            }
            typed = frozenset(s for s, found in values.items() if found.dtype.kind in "mM")
            values |= {source: _seconds(values[source], zeros, source) for source in typed}
            columns = {s: floats(found, s, path, first=first) for s, found in values.items()}
            yield ColumnTable(columns, units | dict.fromkeys(typed, "s"), (), first, typed)
            first += table.num_rows
        if first == 1:
            yield ColumnTable({source: np.empty(0) for source in fields}, units)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    del options
    with reading(path), open_parquet(path) as file:
        return list(file.schema_arrow.names)


def _values(table: pa.Table, name: str, order: int) -> npt.NDArray[Any]:
    """Return column number `order` (from 0) among those of its name."""
    column = table.column(table.schema.get_all_field_indices(name)[order])
    if pa.types.is_dictionary(column.type):  # else a null becomes a value of the dictionary
        column = column.cast(column.type.value_type)
    values: npt.NDArray[Any] = column.to_numpy()
    return values


def _seconds(
    values: npt.NDArray[Any], zeros: dict[ColumnSource, Any], source: ColumnSource
) -> Floats:
    """Return durations, or dates since the first one of the file, in seconds; null is NaN.

    `zeros` holds the first date of each source, for all parts of a file. Seconds since 1970 would
    be exact to a quarter of a microsecond only.
    """
    if values.dtype.kind == "M":
        dates = values[~np.isnat(values)]
        values = values - (zeros.setdefault(source, dates[0]) if dates.size else values)
    seconds: Floats = values / np.timedelta64(1, "s")
    return seconds
