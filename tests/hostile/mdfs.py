"""MDF files whose blocks go in rings, claim or unpack to more than they are."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal

from tests.hostile.case import Case, guessing, ingesting

Change = Callable[[bytearray], None]


def mdf(
    change: Change, version: str = "4.10", *, guess: bool = False
) -> Callable[[Path], list[object]]:
    """Return a maker of an MDF file with t, x and f, changed byte by byte."""

    def make(folder: Path) -> list[object]:
        path = folder / "a.mf4"
        t = np.arange(50) / 10
        with MDF(version=version) as file:
            file.append([Signal(t + k, t, name=name) for k, name in enumerate("txf")])
            file.save(path)
        path = path if path.exists() else path.with_suffix(".mdf")
        content = bytearray(path.read_bytes())
        change(content)
        path.write_bytes(content)
        return guessing(path) if guess else ingesting(path)

    return make


def at(content: bytearray, kind: bytes, number: int = 0) -> int:
    place = -1
    for _ in range(number + 1):
        place = content.index(kind, place + 1)
    return place


def ring(kind: bytes, link: int = 0) -> Change:
    """Let a block be the next after itself."""

    def change(content: bytearray) -> None:
        block = at(content, kind)
        struct.pack_into("<Q", content, block + 24 + 8 * link, block)

    return change


def ring_3(kind: bytes) -> Change:
    def change(content: bytearray) -> None:
        header = struct.unpack_from("<I", content, 68)[0]  # the first data group
        block = header if kind == b"DG" else struct.unpack_from("<I", content, header + 8)[0]
        struct.pack_into("<I", content, block + 4, block)

    return change


def cycles(count: int) -> Change:
    def change(content: bytearray) -> None:
        block = at(content, b"##CG")
        links = struct.unpack_from("<Q", content, block + 16)[0]
        struct.pack_into("<Q", content, block + 24 + 8 * links + 8, count)

    return change


def packed(said: int, real: int) -> Change:
    """Put a packed block of zeros in the place of the data; it says that it has `said` bytes."""

    def change(content: bytearray) -> None:
        begun = zlib.compressobj(9)
        stream = b"".join(begun.compress(bytes(1 << 20)) for _ in range(real >> 20)) + begun.flush()
        place = len(content) + -len(content) % 8
        content += bytes(-len(content) % 8)
        content += struct.pack("<4s4xQQ", b"##DZ", 48 + len(stream), 0)
        content += struct.pack("<2sBxIQQ", b"DT", 0, 0, said, len(stream)) + stream
        struct.pack_into("<Q", content, at(content, b"##DG") + 24 + 16, place)
        cycles(said // 32)(content)

    return change


def deep_list(content: bytearray) -> None:
    """Let a list of data blocks go on with itself."""
    place = len(content) + -len(content) % 8
    content += bytes(-len(content) % 8)
    content += struct.pack("<4s4xQQQQ", b"##DL", 48, 2, place, place) + bytes(8)
    struct.pack_into("<Q", content, at(content, b"##DG") + 24 + 16, place)


def outside(content: bytearray) -> None:
    struct.pack_into("<Q", content, at(content, b"##DG") + 24, 2**62)


CASES = (
    Case("a ring of data groups", mdf(ring(b"##DG")), "the blocks form a cycle"),
    Case("a ring of channel groups", mdf(ring(b"##CG")), "the blocks form a cycle"),
    Case("a ring of channels", mdf(ring(b"##CN")), "the blocks form a cycle"),
    Case("a channel made of itself", mdf(ring(b"##CN", 1)), "the blocks form a cycle"),
    Case("a ring of channels, guessed", mdf(ring(b"##CN"), guess=True), "the blocks form a cycle"),
    Case(
        "a ring of data groups in version 3", mdf(ring_3(b"DG"), "3.30"), "the blocks form a cycle"
    ),
    Case(
        "a ring of channel groups in version 3",
        mdf(ring_3(b"CG"), "3.30"),
        "the blocks form a cycle",
    ),
    Case("a list that goes on with itself", mdf(deep_list), "the blocks form a cycle"),
    Case("a claim of 10^12 cycles", mdf(cycles(10**12)), "at most 500 times its size"),
    Case("a claim of 2^63 cycles", mdf(cycles(2**63)), "at most 500 times its size"),
    Case("a packed block of 4 GB", mdf(packed(1 << 32, 1 << 28)), "at most 500 times its size"),
    Case("a link behind the end", mdf(outside), "cannot be read as MDF"),
)
