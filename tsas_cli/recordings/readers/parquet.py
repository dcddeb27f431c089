"""Parquet files."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

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
        with pq.ParquetFile(path) as file:
            schema = file.schema_arrow
            at = resolve(wanted, schema.names, path)
            table = file.read(columns=[schema.names[i] for i in at.values()])
    except (pa.ArrowException, UnicodeDecodeError) as error:  # the latter is of names
        raise damaged(path, "Parquet", error) from error
    fields = {source: schema.field(i) for source, i in at.items()}
    columns = {
        source: floats(table.column(field.name).to_numpy(), source, path)
        for source, field in fields.items()
    }
    units = {
        s: f.metadata[b"unit"].decode(errors="replace")
        for s, f in fields.items()
        if b"unit" in (f.metadata or {})
    }
    return Table(columns, units)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    del options
    try:
        with pq.ParquetFile(path) as file:
            return list(file.schema_arrow.names)
    except (pa.ArrowException, UnicodeDecodeError) as error:  # the latter is of names
        raise damaged(path, "Parquet", error) from error
