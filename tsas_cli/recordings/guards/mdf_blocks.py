"""The blocks of an MDF file, checked before asammdf follows their links.

A file is a tree: data groups hold channel groups, which hold channels; lists hold blocks of data.
A link back makes a cycle that asammdf follows without end. Packed blocks declare their size.
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.support.errors import InputError

_FIRST = 64  # where the header block is
_VERSION_4 = 400
# Links of a block that lead to its children or to the next block of its kind.
_DOWN_4 = {
    b"##HD": (0,),
    b"##DG": (0, 1, 2),
    b"##CG": (0, 1),
    b"##CN": (0, 1),
    b"##CA": (0,),
    b"##HL": (0,),
}
_LISTS = (b"##DL", b"##LD")  # every link
_DOWN_3 = {b"HD": (0,), b"DG": (0, 1), b"CG": (0, 1), b"CN": (0,)}
_MOST_LINKS = 1 << 16


class _Block(NamedTuple):
    kind: bytes
    down: tuple[int, ...]
    unpacked: int


def check_blocks(path: Path) -> None:
    """Refuse a file whose blocks form a cycle, or unpack to more than a recording can hold."""
    expanded = Expanded.of(path)
    with path.open("rb") as stream:
        head = stream.read(_FIRST)
        if len(head) < _FIRST:
            return  # asammdf reports it
        version = struct.unpack("<H", head[28:30])[0]
        read = _block_4 if version >= _VERSION_4 else _block_3
        seen: set[int] = set()
        ahead = [_FIRST]
        while ahead:
            at = ahead.pop()
            if at >= expanded.of_file:
                continue  # asammdf reports it
            if at in seen:
                raise InputError(
                    f"the block at byte {at} has more than one link to it: the blocks form a cycle",
                    where=path,
                    remedy="it may be damaged: export it again",
                )
            seen.add(at)
            block = read(stream, at)
            expanded.add(block.unpacked, what="unpacked")
            ahead += block.down
    expanded.fits()


def _block_4(stream: BinaryIO, at: int) -> _Block:
    stream.seek(at)
    head = stream.read(24).ljust(24, b"\0")
    kind, _, count = struct.unpack("<4s4xQQ", head)
    wanted = range(min(count, _MOST_LINKS)) if kind in _LISTS else _DOWN_4.get(kind, ())
    links = _links(stream.read(8 * min(count, _MOST_LINKS)), "Q")
    unpacked = 0
    if kind == b"##DZ":
        unpacked = struct.unpack("<8xQ8x", stream.read(24).ljust(24, b"\0"))[0]
    return _Block(kind, tuple(links[i] for i in wanted if i < len(links) and links[i]), unpacked)


def _block_3(stream: BinaryIO, at: int) -> _Block:
    stream.seek(at)
    kind = stream.read(4)[:2]
    links = _links(stream.read(8), "I")
    return _Block(kind, tuple(links[i] for i in _DOWN_3.get(kind, ()) if links[i : i + 1] > [0]), 0)


def _links(content: bytes, one: str) -> list[int]:
    size = struct.calcsize(one)
    whole = len(content) // size
    return list(struct.unpack(f"<{whole}{one}", content[: whole * size]))


def check_claims(path: Path, cycles: Iterator[int]) -> None:
    """Refuse channels that declare more samples than a file of this size can hold."""
    expanded = Expanded.of(path)
    for samples in cycles:
        expanded.add(2 * 8 * samples, what=f"{samples} samples of a channel and their times")
    expanded.fits()
