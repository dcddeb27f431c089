"""Recordings from object storage, fetched whole and held against their checksums before use."""

import hashlib
import mmap
import tempfile
from collections import OrderedDict
from threading import Lock
from typing import IO

from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError

PART = 64 * 1024 * 1024  # bytes of one request
HELD = 1024 * 1024 * 1024  # bytes on disk that are kept for who reads a recording again

_HELD: OrderedDict[tuple[Address, str], mmap.mmap] = OrderedDict()  # a report reads in each section
_LOCK = Lock()


def fetched(address: Address, sha256: str) -> mmap.mmap | None:
    """Return a recording's bytes, which lie on disk while they are used; None for another checksum.

    Raises
    ------
    FileNotFoundError
        It is not there.
    InputError
        The storage cannot be asked, or there is no room for the recording.
    """
    key = address, sha256
    with _LOCK:
        content = _HELD.pop(key, None) or _fetch(address, sha256)
        if content is not None:
            _HELD[key] = content
        while len(_HELD) > 1 and sum(map(len, _HELD.values())) > HELD:
            _HELD.popitem(last=False)
    return content


def _fetch(address: Address, sha256: str) -> mmap.mmap | None:
    digest, size = hashlib.sha256(), address.size()
    with tempfile.TemporaryFile() as file:  # which has no name, so that no kill leaves it
        for start in range(0, size, PART):
            part = address.read_bytes(start, min(start + PART, size))
            digest.update(part)
            _keep(file, part)
        if digest.hexdigest() != sha256 or not size:
            return None
        file.flush()
        return mmap.mmap(file.fileno(), size, access=mmap.ACCESS_READ)


def _keep(file: IO[bytes], part: bytes) -> None:
    try:
        file.write(part)
    except OSError as error:
        raise InputError(
            f"a recording cannot be kept while it is read ({error.strerror})",
            where=tempfile.gettempdir(),
            remedy="make room there, or name another folder in TMPDIR",
        ) from error
