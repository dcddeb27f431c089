"""The file of a run, from a folder or an address, after its checksum is verified."""

import hashlib
import mmap
import tempfile
from collections import OrderedDict
from pathlib import Path
from threading import Lock
from typing import IO, TypeAlias

import pyarrow as pa

from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.storage import Address, Location, NotThereError, check_inside
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of

ParquetSource: TypeAlias = Path | pa.NativeFile


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


REQUEST_BYTES = 16 * 1024 * 1024
CACHE_BYTES = 1024 * 1024 * 1024  # on disk, for recordings that are read again

_CACHE: OrderedDict[tuple[Address, str], mmap.mmap] = OrderedDict()  # each report section reads
_LOCK = Lock()


def fetched(address: Address, sha256: str) -> mmap.mmap | None:
    """Return a recording's bytes, mapped from disk; None if the checksum differs.

    Raises
    ------
    InputError
        There is no such object (`NotThereError`), the storage fails, or the disk has no room for
        the recording.
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
