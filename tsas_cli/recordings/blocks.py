"""A recording on object storage, read in parts of which each is checked.

`tsas upload` puts a list beside each recording: its SHA-256, and one for each block of bytes.
With the list, what is read are blocks, and each is held against its checksum. Without it, or where
it belongs to another file, the whole recording is fetched and held against the manifest's checksum.
"""

import hashlib
import io
import json
import mmap
import tempfile
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from threading import Lock
from typing import IO

import pyarrow as pa

from tsas_cli.recordings.storage import Address
from tsas_cli.support.errors import InputError

SMALLEST, MOST = 16 * 1024, 16384  # bytes of a block; blocks of a file, where it is large
HELD = 64 * 1024 * 1024  # bytes in memory at once, and at most in one request
SUFFIX = ".blocks.json"


class NotTheSameError(Exception):
    """What was read is not what the checksum says."""


@dataclass(frozen=True)
class Blocks:
    """The checksum of a file, its size, and the checksum of each block of `block_bytes`."""

    sha256: str
    size: int
    block_bytes: int
    blocks: tuple[str, ...]

    def content(self) -> bytes:
        """Return it as JSON."""
        told = {
            "format": 1,
            "sha256": self.sha256,
            "size": self.size,
            "block_bytes": self.block_bytes,
            "blocks": self.blocks,
        }
        return (json.dumps(told, indent=1) + "\n").encode()


def blocks_of(path: Path) -> Blocks:
    """Return the checksums of a file."""
    size = path.stat().st_size
    block = SMALLEST
    while block * MOST < size:
        block *= 2
    whole, parts = hashlib.sha256(), []
    with path.open("rb") as file:
        while piece := file.read(block):
            whole.update(piece)
            parts.append(hashlib.sha256(piece).hexdigest())
    return Blocks(whole.hexdigest(), size, block, tuple(parts))


def opened(address: Address, sha256: str) -> "CheckedFile | pa.NativeFile":
    """Open a recording whose bytes are checked before they are handed out.

    Raises
    ------
    FileNotFoundError
        It is not there.
    NotTheSameError
        The recording is another one.
    InputError
        The storage cannot be asked.
    """
    blocks = _listed(address, sha256)
    if blocks is None:
        return _fetched(address, sha256)
    if address.size() != blocks.size:
        raise NotTheSameError
    return CheckedFile(address, blocks)


def _listed(address: Address, sha256: str) -> Blocks | None:
    """Return the list beside a recording, or None where there is none that is of use."""
    try:
        told = json.loads(Address(address.scheme, address.path + SUFFIX).read_bytes())
        blocks = Blocks(
            str(told["sha256"]), int(told["size"]), int(told["block_bytes"]), tuple(told["blocks"])
        )
    except (FileNotFoundError, ValueError, OverflowError, TypeError, KeyError, RecursionError):
        return None
    right = blocks.sha256 == sha256 and 0 < blocks.block_bytes <= HELD
    return blocks if right and len(blocks.blocks) == -(-blocks.size // blocks.block_bytes) else None


def _fetched(address: Address, sha256: str) -> pa.NativeFile:
    """Return a whole recording, which lies on disk as long as somebody reads it."""
    digest, size = hashlib.sha256(), address.size()
    with tempfile.TemporaryFile() as file:
        for start in range(0, size, HELD):
            piece = address.read_bytes(start, min(start + HELD, size))
            digest.update(piece)
            _kept(file, piece)
        if digest.hexdigest() != sha256 or not size:
            raise NotTheSameError
        file.flush()
        return pa.BufferReader(mmap.mmap(file.fileno(), size, access=mmap.ACCESS_READ))


def _kept(file: IO[bytes], piece: bytes) -> None:
    try:
        file.write(piece)
    except OSError as error:
        raise InputError(
            f"a recording cannot be kept while it is read ({error.strerror})",
            where=tempfile.gettempdir(),
            remedy="make room there, or name another folder in TMPDIR",
        ) from error


class CheckedFile(io.RawIOBase):
    """A file of which only what is asked for is fetched, in blocks with a checksum each."""

    def __init__(self, address: Address, blocks: Blocks) -> None:
        self._address, self._blocks, self._at = address, blocks, 0

    def readable(self) -> bool:
        """Say that it can be read."""
        return True

    def seekable(self) -> bool:
        """Say that it can be read from any place on."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        begins = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._blocks.size}
        self._at = max(begins[whence] + offset, 0)
        return self._at

    def tell(self) -> int:
        """Return the place."""
        return self._at

    def read(self, size: int = -1) -> bytes:
        """Return so many bytes from the place on, fewer only at the end.

        Raises
        ------
        NotTheSameError
            A block is not what its checksum says.
        """
        end = self._blocks.size if size < 0 else min(self._at + size, self._blocks.size)
        if end <= self._at:
            return b""
        step, begin = self._blocks.block_bytes, self._at
        content = bytearray()
        first, last = begin // step, (end - 1) // step
        for k in range(first, last + 1, HELD // step):
            content += b"".join(self._read(range(k, min(k + HELD // step, last + 1))))
        self._at = end
        return bytes(memoryview(content)[begin - first * step : end - first * step])

    def _read(self, wanted: range) -> list[bytes]:
        """Return some blocks; those that are not held are fetched, neighbours with one request."""
        found = {k: _HELD_BLOCKS.get(self._key(k)) for k in wanted}
        missing = [k for k, block in found.items() if block is None]
        for _, group in groupby(enumerate(missing), lambda pair: pair[1] - pair[0]):
            numbers = [number for _, number in group]
            found.update(self._fetch(numbers[0], numbers[-1] + 1))
        blocks = [block for block in found.values() if block is not None]
        _hold({self._key(k): block for k, block in zip(wanted, blocks, strict=True)})
        return blocks

    def _key(self, number: int) -> tuple[Address, str, int]:
        return self._address, self._blocks.sha256, number

    def _fetch(self, first: int, end: int) -> Iterator[tuple[int, bytes]]:
        step = self._blocks.block_bytes
        content = self._address.read_bytes(first * step, min(end * step, self._blocks.size))
        for k in range(first, end):
            block = content[(k - first) * step : (k - first + 1) * step]
            if hashlib.sha256(block).hexdigest() != self._blocks.blocks[k]:
                raise NotTheSameError
            yield k, block


# What was checked last, for those who read a recording again: a report does for each section.
_HELD_BLOCKS: OrderedDict[tuple[Address, str, int], bytes] = OrderedDict()
_LOCK = Lock()


def _hold(blocks: dict[tuple[Address, str, int], bytes]) -> None:
    with _LOCK:
        for key, block in blocks.items():
            _HELD_BLOCKS[key] = block
            _HELD_BLOCKS.move_to_end(key)
        held = sum(map(len, _HELD_BLOCKS.values()))
        while held > HELD:
            held -= len(_HELD_BLOCKS.popitem(last=False)[1])
