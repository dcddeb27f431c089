"""Parquet files, opened only where what they say of themselves is within the limits."""

import struct
from collections.abc import Collection
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli import limits
from tsas_cli.errors import InputError
from tsas_cli.memory import Expanded

_TEXT_BEHIND = 8  # bytes at the end: the footer's length and PAR1


def open_parquet(path: Path) -> pq.ParquetFile:
    """Open a Parquet file; none of its rows is read.

    Raises
    ------
    InputError
        It is no regular file, or holds more columns or a longer footer than a recording.
    ArrowException, OSError, UnicodeDecodeError
        It cannot be read.
    """
    limits.regular(path)
    with path.open("rb") as stream:
        stream.seek(max(0, path.stat().st_size - _TEXT_BEHIND))
        length = struct.unpack("<I", stream.read(4).rjust(4, b"\0"))[0]
        whole = stream.read() == b"PAR1"
    if whole and length > limits.FOOTER:
        raise InputError(
            f"its footer has {limits.size(length)}",
            where=path,
            expected=f"at most {limits.size(limits.FOOTER)}",
            remedy="write it with fewer row groups and columns",
        )
    file = pq.ParquetFile(path)
    limits.columns(file.schema_arrow.names, path)
    return file


def check_size(file: pq.ParquetFile, path: Path, names: Collection[str], *, whole: bool) -> None:
    """Refuse a file that says it holds more than a file of its size can hold.

    Parameters
    ----------
    names
        The columns that will be read.
    whole
        Whether they will be in memory at once.

    Raises
    ------
    InputError
        It does, or, where they are loaded whole, they are larger than the memory.
    """
    expanded = Expanded.of(path, limits.PARQUET_EXPANSION)
    metadata = file.metadata
    leaves = [
        leaf
        for leaf in range(metadata.num_columns)
        if metadata.schema.column(leaf).path.split(".")[0] in names
    ]
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        for leaf in leaves:
            chunk = group.column(leaf)
            rows = max(group.num_rows, chunk.num_values)
            each = 8 if chunk.physical_type != "BYTE_ARRAY" else chunk.total_uncompressed_size
            expanded.add(rows * each, what=f"{metadata.num_rows} rows")
    if whole:
        expanded.fits()


def is_number(kind: pa.DataType) -> bool:
    """Say whether a column's type is one of numbers; of nothing but nulls counts too."""
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_null(kind))
