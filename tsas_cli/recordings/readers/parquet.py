"""Parquet files."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from tsas_cli.memory import out_of_memory
from tsas_cli.recordings.parquet_files import check_size, open_parquet
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source, Table, damaged, floats, resolve


def read(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Table:
    """Read the wanted columns of a Parquet file; units from the fields' metadata `unit`.

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
            names = [schema.names[i] for i in at.values()]
            check_size(file, path, names, whole=True)
            table = file.read(columns=names)
    except MemoryError as error:
        raise out_of_memory(path) from error
    except pa.ArrowException as error:
        raise damaged(path, "Parquet", error) from error
    fields = {source: schema.field(i) for source, i in at.items()}
    columns = {
        source: floats(table.column(field.name).to_numpy(), source, path)
        for source, field in fields.items()
    }
    units = {
        s: f.metadata[b"unit"].decode() for s, f in fields.items() if b"unit" in (f.metadata or {})
    }
    return Table(columns, units)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    del options
    try:
        with open_parquet(path) as file:
            return list(file.schema_arrow.names)
    except pa.ArrowException as error:
        raise damaged(path, "Parquet", error) from error
