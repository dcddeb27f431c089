"""Parquet files, opened only if their footers are within the limits."""

import io
import struct
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, cast

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.checked import ParquetSource
from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.recordings.storage import Location
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.memory import out_of_memory

BUFFER_BYTES = 1 << 20  # read at a time: a row group need not fit into memory
_TRAILER_BYTES = 8  # at the end: the footer's length and PAR1


@contextmanager
def reading(path: object) -> Iterator[None]:
    """Convert the errors of pyarrow at a damaged or too large file to `InputError`."""
    try:
        yield
    except MemoryError as error:
        raise out_of_memory(path) from error
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:  # the last is of names
        if isinstance(error, OSError) and error.errno is not None:  # not of the content
            raise InputError(f"cannot be read ({error.strerror})", where=path) from error
        raise damaged(path, "Parquet", error) from error


def open_parquet(source: ParquetSource, where: Location | None = None) -> pq.ParquetFile:
    """Return an open Parquet file; no row is read.

    `where` is the location in error messages; default: the source.

    Raises
    ------
    InputError
        It is no regular file, or its columns or its footer exceed a limit.
    ArrowException, OSError, UnicodeDecodeError
        The file cannot be read.
    """
    path = where or source
    if isinstance(source, Path):
        limits.regular(source)
        with source.open("rb") as stream:
            _check_footer(stream, path)
    else:
        _check_footer(source, path)
    # Pre-buffered data would stay in memory until the file is closed.
    file = pq.ParquetFile(source, buffer_size=BUFFER_BYTES, pre_buffer=False)
    limits.columns(file.schema_arrow.names, path)
    return file


def size_of(source: ParquetSource) -> int:
    """Return the size of a file [bytes]."""
    return source.stat().st_size if isinstance(source, Path) else int(source.size())


def _check_footer(stream: IO[bytes] | pa.NativeFile, path: object) -> None:
    """Refuse a footer that exceeds its limit."""
    size = int(stream.seek(0, io.SEEK_END))
    stream.seek(max(0, size - _TRAILER_BYTES))
    length, mark = struct.unpack("<I4s", stream.read().rjust(_TRAILER_BYTES, b"\0"))
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
    path: Location,
    names: Collection[str],
    *,
    whole: bool,
    size: int | None = None,
) -> None:
    """Refuse a file whose footer claims more data than its size can hold.

    The columns `names` are to be read, at once if `whole`; `size` is that of the file [bytes], by
    default that of `path`.

    InputError: it does; or the columns exceed the memory, if they are read whole.
    """
    of_file = cast("Path", path).stat().st_size if size is None else size
    expanded = Expanded(path, of_file, limits.PARQUET_EXPANSION)
    metadata = file.metadata
    every = (metadata.schema.column(leaf) for leaf in range(metadata.num_columns))
    leaves = [leaf for leaf in every if leaf.path.split(".")[0] in names]
    for leaf in leaves:
        if leaf.max_repetition_level > 0:
            raise InputError(f"column {leaf.path} holds lists", where=path, expected="numbers")
    # From the row groups alone: on a damaged column, pyarrow ends the process.
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        for leaf in leaves:
            each = 8 if leaf.physical_type != "BYTE_ARRAY" else group.total_byte_size
            expanded.add(group.num_rows * each, what=f"{metadata.num_rows} rows")
    if whole:
        expanded.fits()


def is_number(kind: pa.DataType) -> bool:
    """Return whether a column's type is numeric, or null throughout."""
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_null(kind))
