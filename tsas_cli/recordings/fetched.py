"""Recordings from object storage, fetched whole and verified by checksum before use."""

import hashlib
import mmap
import tempfile
from collections import OrderedDict
from threading import Lock
from typing import IO

from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError

REQUEST_BYTES = 64 * 1024 * 1024
CACHE_BYTES = 1024 * 1024 * 1024  # on disk, for recordings that are read again

_CACHE: OrderedDict[tuple[Address, str], mmap.mmap] = OrderedDict()  # each report section reads
_LOCK = Lock()


def fetched(address: Address, sha256: str) -> mmap.mmap | None:
    """Return a recording's bytes, mapped from disk; None if the checksum differs.

    Raises
    ------
    FileNotFoundError
        There is no such object.
    InputError
        The storage fails, or the disk has no room for the recording.
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
            part = address.read_bytes(start, min(start + REQUEST_BYTES, size))
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
