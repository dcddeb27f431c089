"""Unpacked size of the compressed variables of a MATLAB 5 file, checked before they are loaded."""

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
_MOST_PACKED = 1032  # bytes per compressed byte, at most
_PART = 1 << 12


def check_unpacked(path: Path) -> None:
    """Refuse a file that unpacks to more than a recording can hold, or exceeds the memory.

    The declared size of a variable may be false, so a file that could be large is first unpacked in
    parts to count its bytes.
    """
    claimed, expanded = Expanded.of(path), Expanded.of(path)
    if expanded.of_file * _MOST_PACKED <= limits.HARMLESS:
        return
    with path.open("rb") as stream:
        order = _ORDERS.get(stream.read(_HEADER)[-2:], "")
        for kind, size in _elements(stream, order):
            declared = (
                _declared_size(stream.read(min(size, _PART)), order) if kind == _PACKED else size
            )
            claimed.add(declared, what="unpacked")
        claimed.fits()
        for kind, size in _elements(stream, order):
            for part in _parts(stream, size) if kind == _PACKED else (size,):
                expanded.grow(part, what="unpacked")
    expanded.fits()


def _elements(stream: BinaryIO, order: str) -> Iterator[tuple[int, int]]:
    """Yield kind and size of each variable, with the stream at its beginning."""
    end = _HEADER
    stream.seek(end)
    while order and len(tag := stream.read(_TAG)) == _TAG:
        kind, size = struct.unpack(f"{order}II", tag)
        end += _TAG + size
        yield kind, size
        stream.seek(end)


def _declared_size(packed: bytes, order: str) -> int:
    """Return the declared size of a packed variable [bytes]; 0 if it cannot be unpacked."""
    try:
        tag = zlib.decompressobj().decompress(packed, _TAG)
    except zlib.error:
        return 0
    return int(struct.unpack(f"{order}II", tag)[1]) if len(tag) == _TAG else 0


def _parts(stream: BinaryIO, size: int) -> Iterator[int]:
    """Yield the unpacked sizes of the parts of the next `size` bytes."""
    packed = zlib.decompressobj()
    while size > 0 and (content := stream.read(min(size, _PART))):
        size -= len(content)
        while content:
            try:
                yield len(packed.decompress(content, _MOST_PACKED * _PART))
            except zlib.error:  # the reader reports it
                return
            content = packed.unconsumed_tail
