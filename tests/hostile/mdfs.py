"""MDF files whose blocks go in rings, claim or unpack to more than they are."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal

from tests.hostile.case import Make, cases, guessing, ingesting

Change = Callable[[bytearray], None]


def mdf(change: Change, version: str = "4.10", *, guess: bool = False) -> Make:
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


def ring(kind: bytes, link: int = 0) -> Change:
    """Let a block be the next after itself."""

    def change(content: bytearray) -> None:
        block = content.index(kind)
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
        block = content.index(b"##CG")
        links = struct.unpack_from("<Q", content, block + 16)[0]
        struct.pack_into("<Q", content, block + 24 + 8 * links + 8, count)

    return change


def append(content: bytearray, block: bytes) -> None:
    """Put a block behind the end, in the place of the data."""
    content += bytes(-len(content) % 8)
    struct.pack_into("<Q", content, content.index(b"##DG") + 24 + 16, len(content))
    content += block


def packed(said: int, real: int) -> Change:
    """Put a packed block of zeros in the place of the data; it says that it has `said` bytes."""

    def change(content: bytearray) -> None:
        begun = zlib.compressobj(9)
        stream = b"".join(begun.compress(bytes(1 << 20)) for _ in range(real >> 20)) + begun.flush()
        block = struct.pack("<4s4xQQ", b"##DZ", 48 + len(stream), 0)
        append(content, block + struct.pack("<2sBxIQQ", b"DT", 0, 0, said, len(stream)) + stream)
        cycles(said // 32)(content)

    return change


def deep_list(content: bytearray) -> None:
    """Let a list of data blocks go on with itself."""
    place = len(content) + -len(content) % 8
    append(content, struct.pack("<4s4xQQQQ", b"##DL", 48, 2, place, place) + bytes(8))


def outside(content: bytearray) -> None:
    struct.pack_into("<Q", content, content.index(b"##DG") + 24, 2**62)


CASES = cases(
    {
        "the blocks form a cycle": {
            "a ring of data groups": mdf(ring(b"##DG")),
            "a ring of channel groups": mdf(ring(b"##CG")),
            "a ring of channels": mdf(ring(b"##CN")),
            "a channel made of itself": mdf(ring(b"##CN", 1)),
            "a ring of channels, guessed": mdf(ring(b"##CN"), guess=True),
            "a ring of data groups in version 3": mdf(ring_3(b"DG"), "3.30"),
            "a ring of channel groups in version 3": mdf(ring_3(b"CG"), "3.30"),
            "a list that goes on with itself": mdf(deep_list),
        },
        "at most 500 times its size": {
            "a claim of 10^12 cycles": mdf(cycles(10**12)),
            "a claim of 2^63 cycles": mdf(cycles(2**63)),
            "a packed block of 4 GB": mdf(packed(1 << 32, 1 << 28)),
        },
        "cannot be read as MDF": {"a link behind the end": mdf(outside)},
    }
)
