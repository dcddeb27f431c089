"""Parquet files."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from tsas_cli.memory import out_of_memory
from tsas_cli.recordings.parquet_files import check_size, open_parquet
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import (
    BATCH_ROWS,
    Source,
    Table,
    damaged,
    floats,
    in_batches,
    resolve,
)


def batches(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Iterator[Table]:
    """Read the wanted columns of a Parquet file in parts; units from the fields' metadata `unit`.

    Raises
    ------
    InputError
        It is no whole Parquet file, a column is missing, or it holds something else than numbers.
    """
    del options
    try:
        with open_parquet(path) as file:
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
            first = 1
            for table in in_batches(file.iter_batches(BATCH_ROWS, columns=names)):
                columns = {
                    source: floats(table.column(field.name).to_numpy(), source, path, first=first)
                    for source, field in fields.items()
                }
                yield Table(columns, units, first_row=first)
                first += table.num_rows
            if first == 1:
                yield Table({source: np.empty(0) for source in fields}, units)
    except MemoryError as error:
        raise out_of_memory(path) from error
    except (pa.ArrowException, UnicodeDecodeError) as error:  # the latter is of names
        raise damaged(path, "Parquet", error) from error


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    del options
    try:
        with open_parquet(path) as file:
            return list(file.schema_arrow.names)
    except (pa.ArrowException, UnicodeDecodeError) as error:  # the latter is of names
        raise damaged(path, "Parquet", error) from error
