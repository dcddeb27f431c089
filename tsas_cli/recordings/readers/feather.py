"""Feather: Arrow's own files."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy.typing as npt
import pyarrow as pa

from tsas_cli.recordings.parquet_files import unit_of
from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import ReadOptions


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the columns of a Feather file; units from field metadata `unit`."""
    with pa.OSFile(str(path)) as stream, pa.ipc.open_file(stream) as file:
        yield Offered(
            [
                Column(field.name, partial(_values, file, i), unit_of(field))
                for i, field in enumerate(file.schema)
            ]
        )


def _values(file: pa.ipc.RecordBatchFileReader, number: int) -> npt.NDArray[Any]:
    batches = [file.get_batch(i) for i in range(file.num_record_batches)]
    for batch in batches:
        batch.validate(full=True)
    columns = [batch.column(number) for batch in batches]
    return to_numpy(pa.chunked_array(columns, file.schema.types[number]))


def to_numpy(column: pa.ChunkedArray) -> npt.NDArray[Any]:
    """Return a column as an array, shape (n,); null is NaN or NaT."""
    if pa.types.is_dictionary(column.type):  # else a null becomes a value of the dictionary
        column = column.cast(column.type.value_type)
    values: npt.NDArray[Any] = column.to_numpy()
    return values
