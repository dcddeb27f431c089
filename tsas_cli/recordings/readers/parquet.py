"""Parquet files."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from tsas_cli.recordings.parquet_files import (
    check_size,
    in_batches,
    open_parquet,
    reading,
    unit_of,
)
from tsas_cli.recordings.readers.feather import to_numpy
from tsas_cli.recordings.readers.table import (
    BATCH_ROWS,
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    resolve,
    unit_in,
)
from tsas_cli.recordings.readers.timebase import Seconds


def batches(path: Path, _: ReadOptions, wanted: Sequence[ColumnSource]) -> Iterator[ColumnTable]:
    """Yield the requested columns of a Parquet file in parts; units from field metadata `unit`.

    Dates become seconds since the first one in their column, durations become seconds.

    InputError: the file is damaged, or a column is missing or not numeric.
    """
    with reading(path), open_parquet(path) as file:
        schema = file.schema_arrow
        at = resolve(wanted, schema.names, path)
        fields = {source: schema.field(i) for source, i in at.items()}
        units = {s: unit for s, f in fields.items() if (unit := unit_of(f) or unit_in(f.name))}
        names = [field.name for field in fields.values()]
        check_size(file, path, names, whole=False)
        # A duplicate name is read twice: `order` is the number among columns of that name.
        order = {s: schema.get_all_field_indices(schema.names[i]).index(i) for s, i in at.items()}
        seconds = {source: Seconds() for source in fields}
        first = 1
        for table in in_batches(file.iter_batches(BATCH_ROWS, columns=names), BATCH_ROWS):
            values = {
                source: to_numpy(
                    table.column(table.schema.get_all_field_indices(field.name)[order[source]])
                )
                for source, field in fields.items()
            }
            typed = frozenset(s for s, found in values.items() if found.dtype.kind in "mM")
            values |= {source: seconds[source](values[source]) for source in typed}
            columns = {s: floats(found, s, path, first=first) for s, found in values.items()}
            yield ColumnTable(columns, units | dict.fromkeys(typed, "s"), (), first, typed)
            first += table.num_rows
        if first == 1:
            yield ColumnTable({source: np.empty(0) for source in fields}, units)


def names(path: Path, _: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    with reading(path), open_parquet(path) as file:
        return list(file.schema_arrow.names)
