"""Parquet files, opened only where what they say of themselves is within the limits."""

import io
import struct
from collections.abc import Collection
from pathlib import Path
from typing import IO, cast

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.checked import Source
from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.recordings.storage import Place
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

BUFFER = 1 << 20  # bytes that are read at a time: a row group need not fit into memory
_TEXT_BEHIND = 8  # bytes at the end: the footer's length and PAR1


def open_parquet(source: Source, where: Place | None = None) -> pq.ParquetFile:
    """Open a Parquet file; none of its rows is read.

    `where` is what errors name, where the source is no path.

    Raises
    ------
    InputError
        It is no regular file, or holds more columns or a longer footer than a recording.
    ArrowException, OSError, UnicodeDecodeError
        It cannot be read.
    """
    path = where or source
    if isinstance(source, Path):
        limits.regular(source)
        with source.open("rb") as stream:
            _check_footer(stream, path)
    else:
        _check_footer(source, path)
    # What is read before it is asked for stays in memory until the file is closed.
    file = pq.ParquetFile(source, buffer_size=BUFFER, pre_buffer=False)
    limits.columns(file.schema_arrow.names, path)
    return file


def size_of(source: Source) -> int:
    """Return how many bytes a file has."""
    return source.stat().st_size if isinstance(source, Path) else int(source.size())


def _check_footer(stream: IO[bytes] | pa.NativeFile, path: object) -> None:
    """Refuse a footer that is longer than that of a recording."""
    size = int(stream.seek(0, io.SEEK_END))
    stream.seek(max(0, size - _TEXT_BEHIND))
    length, mark = struct.unpack("<I4s", stream.read().rjust(_TEXT_BEHIND, b"\0"))
    stream.seek(0)
    if mark == b"PAR1" and length > limits.FOOTER:
        raise InputError(
            f"its footer has {limits.size(length)}",
            where=path,
            expected=f"at most {limits.size(limits.FOOTER)}",
            remedy="write it with fewer row groups and columns",
        )


def check_size(
    file: pq.ParquetFile,
    path: Place,
    names: Collection[str],
    *,
    whole: bool,
    size: int | None = None,
) -> None:
    """Refuse a file that says it holds more than a file of its size can hold.

    Parameters
    ----------
    names
        The columns that will be read.
    whole
        Whether they will be in memory at once.
    size
        Bytes of the file; those of `path` without it.

    Raises
    ------
    InputError
        It does, or, where they are loaded whole, they are larger than the memory.
    """
    of_file = cast("Path", path).stat().st_size if size is None else size
    expanded = Expanded(path, of_file, limits.PARQUET_EXPANSION)
    metadata = file.metadata
    every = (metadata.schema.column(leaf) for leaf in range(metadata.num_columns))
    leaves = [leaf for leaf in every if leaf.path.split(".")[0] in names]
    for leaf in leaves:
        if leaf.max_repetition_level > 0:
            raise InputError(f"column {leaf.path} holds lists", where=path, expected="numbers")
    # Of the groups alone: asked for a damaged column, pyarrow ends the process.
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        for leaf in leaves:
            each = 8 if leaf.physical_type != "BYTE_ARRAY" else group.total_byte_size
            expanded.add(group.num_rows * each, what=f"{metadata.num_rows} rows")
    if whole:
        expanded.fits()


def is_number(kind: pa.DataType) -> bool:
    """Say whether a column's type is one of numbers; of nothing but nulls counts too."""
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_null(kind))
