"""Parquet files: fetched, verified, and opened only if their footers are within the limits."""

import hashlib
import io
import mmap
import struct
import tempfile
from collections import OrderedDict
from collections.abc import Collection, Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from threading import Lock
from typing import IO, TypeAlias, cast

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.guards import Expanded, foreign
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.storage import Address, Location, NotThereError, check_inside
from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of

ParquetSource: TypeAlias = Path | pa.NativeFile
REQUEST_BYTES = 16 * 1024 * 1024
CACHE_BYTES = 1024 * 1024 * 1024  # on disk, for recordings that are read again
_CACHE: OrderedDict[tuple[Address, str], mmap.mmap] = OrderedDict()  # each report section reads
_LOCK = Lock()
BUFFER_BYTES = 1 << 20  # read at a time: a row group need not fit into memory
_TRAILER_BYTES = 8  # at the end: the footer's length and PAR1


def reading(path: object) -> AbstractContextManager[None]:
    """Convert the errors of pyarrow at a damaged or too large file to `InputError`."""
    errors = pa.ArrowException, OSError, UnicodeDecodeError  # the last is of names
    return foreign(path, "Parquet", errors)


def open_parquet(source: ParquetSource, where: Location | None = None) -> pq.ParquetFile:
    """Return an open Parquet file; no row is read.

    `where` is the location in error messages; default: the source.

    InputError: it is no regular file, or its columns or its footer exceed a limit.
    ArrowException, OSError, UnicodeDecodeError: the file cannot be read.
    """
    path = where or source
    if isinstance(source, Path):
        limits.regular(source)
        source = pa.OSFile(str(source))
    _check_footer(source, path)
    # Pre-buffered data would stay in memory until the file is closed.
    file = pq.ParquetFile(source, buffer_size=BUFFER_BYTES, pre_buffer=False)
    limits.columns(file.schema_arrow.names, path)
    return file


def size_of(source: ParquetSource) -> int:
    """Return the size of a file [bytes]."""
    return source.stat().st_size if isinstance(source, Path) else int(source.size())


def _check_footer(stream: pa.NativeFile, path: object) -> None:
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
    # The path of a leaf begins with its column's name, which may hold dots itself.
    starts = tuple(f"{name}." for name in names)
    leaves = [leaf for leaf in every if f"{leaf.path}.".startswith(starts)]
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


def unit_of(field: pa.Field) -> str:
    """Return the unit in a field's metadata, or empty text."""
    stated: bytes = (field.metadata or {}).get(b"unit", b"")
    return stated.decode(errors="replace")


def floats_from(column: pa.ChunkedArray) -> Floats:
    """Return a column of numbers as float64, shape (n,), null as NaN.

    pyarrow's own conversion loads pandas, which takes a third of a second.

    ArrowInvalid, ArrowNotImplementedError: the column is not numeric.
    """
    whole = column.cast(pa.float64(), safe=False).combine_chunks()
    if not len(whole):
        return np.empty(0)
    validity, numbers = whole.buffers()
    values: Floats = np.frombuffer(numbers, np.float64, len(whole), whole.offset * 8)
    if not whole.null_count:
        return values
    bits = np.unpackbits(np.frombuffer(validity, np.uint8), bitorder="little")
    valid = bits[whole.offset : whole.offset + len(whole)].astype(np.bool_)
    return np.where(valid, values, np.nan)


def in_batches(
    batches: Iterable[pa.RecordBatch], rows: int, *, overlap: int = 0
) -> Iterator[pa.Table]:
    """Yield tables of so many rows from batches of any size; the last one may be shorter.

    Consecutive tables share `overlap` rows.
    """
    waiting: list[pa.RecordBatch] = []
    count = shared = 0
    for batch in batches:
        waiting.append(batch)
        count += batch.num_rows
        while count >= rows:
            table = pa.Table.from_batches(waiting)
            yield table.slice(0, rows)
            shared, count = overlap, count - rows + overlap
            waiting = table.slice(rows - overlap).to_batches()
    if count > shared:
        yield pa.Table.from_batches(waiting)


def column_of(values: Floats) -> pa.Array:
    """Return an array, shape (n,), as a column of float64, NaN as null."""
    numbers = np.ascontiguousarray(values, dtype=np.float64)
    missing = np.isnan(numbers)
    validity = pa.py_buffer(np.packbits(~missing, bitorder="little")) if missing.any() else None
    return pa.Array.from_buffers(
        pa.float64(), numbers.size, [validity, pa.py_buffer(numbers)], int(missing.sum())
    )


def checked_file(folder: Location, run: Run) -> ParquetSource:
    """Return the source that Parquet is read from, after its checksum matches the manifest.

    InputError: the file is missing, leaves its folder or has another checksum, or cannot be
    fetched.
    """
    if isinstance(folder, Address):
        path = folder / run.file
        try:
            content = fetched(path, run.sha256.lower())
        except NotThereError as error:
            raise _missing(path, run) from error
        if content is None:
            raise changed(path, run)
        return pa.BufferReader(content)
    file = local_file(folder, run)
    try:
        digest = sha256_of(file)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=file) from error
    if digest != run.sha256.lower():
        raise changed(file, run)
    return file


def local_file(folder: Path, run: Run) -> Path:
    """Return a run's file in a local folder.

    InputError: the file is missing, or a link leads out of the folder.
    """
    path = folder / run.file
    if not path.is_file():
        raise _missing(path, run)
    check_inside(path, folder)
    return path


def _missing(path: Location, run: Run) -> InputError:
    return InputError(
        "the run's file is missing", where=path, expected=f"the Parquet file of run {run.id}"
    )


def changed(path: Location, run: Run) -> InputError:
    """Return the error for a file whose checksum differs from the manifest."""
    return InputError(
        "the checksum differs from the manifest's",
        where=path,
        expected=run.sha256.lower(),
        remedy="the file has changed since ingest: restore it or ingest again",
    )


def fetched(address: Address, sha256: str) -> mmap.mmap | None:
    """Return a recording's bytes, mapped from disk; None if the checksum differs.

    InputError: there is no such object (`NotThereError`), the storage fails, or the disk has no
    room for the recording.
    """
    key = address, sha256
    with _LOCK:
        content = _CACHE.pop(key, None) or _fetch(address, sha256)
        if content is not None:
            _CACHE[key] = content
        while len(_CACHE) > 1 and sum(map(len, _CACHE.values())) > CACHE_BYTES:
            _CACHE.popitem(last=False)
    return content


def _fetch(address: Address, sha256: str) -> mmap.mmap | None:
    digest, size = hashlib.sha256(), address.size()
    # Unnamed: a killed process leaves nothing. Unbuffered: no rest is written at the end.
    with tempfile.TemporaryFile(buffering=0) as file:
        for start in range(0, size, REQUEST_BYTES):
            part = address.read_part(start, min(start + REQUEST_BYTES, size))
            digest.update(part)
            _write(file, part)
        if digest.hexdigest() != sha256 or not size:
            return None
        return mmap.mmap(file.fileno(), size, access=mmap.ACCESS_READ)


def _write(file: IO[bytes], part: bytes) -> None:
    rest = memoryview(part)
    try:
        while rest:
            rest = rest[file.write(rest) :]
    except OSError as error:
        raise InputError(
            f"a recording cannot be stored while it is read ({error.strerror})",
            where=tempfile.gettempdir(),
            remedy="make room there, or name another folder in TMPDIR",
        ) from error
