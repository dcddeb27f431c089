"""How large the packed variables of a MATLAB 5 file are, before they are unpacked."""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.support import limits

_HEADER, _TAG = 128, 8
_ORDERS = {b"IM": "<", b"MI": ">"}
_PACKED = 15
_MOST_PACKED = 1032  # bytes that zlib makes of one, at most
_PART = 1 << 12


def check_unpacked(path: Path) -> None:
    """Refuse a file that unpacks to more than a recording can be, or than the memory holds.

    What a variable says of its own size may be a lie, so what could be large is unpacked once for
    its size alone, a part at a time.

    Raises
    ------
    InputError
        It does, or holds too many variables.
    """
    claimed, expanded = Expanded.of(path), Expanded.of(path)
    if expanded.of_file * _MOST_PACKED <= limits.HARMLESS:
        return
    with path.open("rb") as stream:
        order = _ORDERS.get(stream.read(_HEADER)[-2:], "")
        for kind, size in _elements(stream, order):
            said = _said(stream.read(min(size, _PART)), order) if kind == _PACKED else size
            claimed.add(said, what="unpacked")
        claimed.fits()
        for kind, size in _elements(stream, order):
            for part in _parts(stream, size) if kind == _PACKED else (size,):
                expanded.grow(part, what="unpacked")
    expanded.fits()


def _elements(stream: BinaryIO, order: str) -> Iterator[tuple[int, int]]:
    """Yield kind and size of each variable, the stream being where it begins."""
    end = _HEADER
    stream.seek(end)
    while order and len(tag := stream.read(_TAG)) == _TAG:
        kind, size = struct.unpack(f"{order}II", tag)
        end += _TAG + size
        yield kind, size
        stream.seek(end)


def _said(packed: bytes, order: str) -> int:
    """Return what a packed variable says of its size; nothing where it cannot be unpacked."""
    try:
        tag = zlib.decompressobj().decompress(packed, _TAG)
    except zlib.error:
        return 0
    return int(struct.unpack(f"{order}II", tag)[1]) if len(tag) == _TAG else 0


def _parts(stream: BinaryIO, size: int) -> Iterator[int]:
    """Yield the sizes of the parts of what is packed into the next `size` bytes."""
    packed = zlib.decompressobj()
    while size > 0 and (content := stream.read(min(size, _PART))):
        size -= len(content)
        while content:
            try:
                yield len(packed.decompress(content, _MOST_PACKED * _PART))
            except zlib.error:  # which the reader will say
                return
            content = packed.unconsumed_tail
