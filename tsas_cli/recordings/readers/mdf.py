"""ASAM MDF measurement files."""

import struct
from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from tsas_cli.recordings.guards import Expanded
from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import ReadOptions, floats, optional
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
_KINDS = {1: "a time", 2: "an angle", 3: "a distance", 4: "a count"}  # a master's `cn_sync_type`
_MASTER_ELSEWHERE = 8  # of `cg_flags`: the master is that of another group


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the channels of an MDF file, with those marked as invalid as NaN.

    InputError: asammdf is not installed, or the file's blocks or samples exceed a limit.
    """
    asammdf = optional("asammdf", extra="mdf")
    check_blocks(path)
    claimed = Expanded.of(path)

    @cache
    def signal(name: str, group: int, index: int) -> Any:
        samples = file.groups[group].channel_group.cycles_nr
        claimed.add(2 * 8 * samples, what=f"{samples} samples of a channel and their times")
        claimed.fits()
        return file.get(name, group, index, ignore_invalidation_bits=True)

    def values(name: str, group: int, index: int) -> Any:
        found = signal(name, group, index)
        if found.invalidation_bits is None:
            return found.samples
        invalid = np.asarray(found.invalidation_bits, dtype=bool)
        return np.where(invalid, np.nan, floats(found.samples, name, path))

    with asammdf.MDF(path) as file:
        columns = [
            Column(
                channel.name,
                partial(values, channel.name, group, index),
                file.get_channel_unit(group=group, index=index),
                partial(lambda *at: signal(*at).timestamps, channel.name, group, index),
                _clock(file, group),
            )
            for group, content in enumerate(file.groups)
            for index, channel in enumerate(content.channels)
            if index != file.masters_db.get(group)
        ]
        header = (str(file.header.comment), f"started {file.start_time.isoformat()}")
        yield Offered(columns, header)


def _clock(file: Any, group: int) -> str:
    """Return what a group's master is, and its unit; the default of a time is seconds."""
    of_group = file.groups[group].channel_group
    if getattr(of_group, "flags", 0) & _MASTER_ELSEWHERE:
        return _clock(file, of_group.cg_master_index)
    index = file.masters_db.get(group)
    if index is None:
        return "a count in samples"
    master = file.groups[group].channels[index]
    kind = _KINDS.get(getattr(master, "sync_type", 1), "nothing")  # MDF 3 has times only
    return f"{kind} in {str(file.get_channel_unit(group=group, index=index)).strip() or 's'}"


def check_blocks(path: Path) -> None:
    """Refuse a file whose blocks form a cycle, or unpack to more than a recording can hold.

    Data groups hold channel groups, which hold channels; lists hold blocks of data. asammdf follows
    a link back without end.
    """
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
            stream.seek(at)
            down, unpacked = read(stream)
            expanded.add(unpacked, what="unpacked")
            ahead += down
    expanded.fits()


def _block_4(stream: BinaryIO) -> tuple[list[int], int]:
    """Return the places that a block leads down to, and its unpacked size [bytes]."""
    head = stream.read(24).ljust(24, b"\0")
    kind, _, count = struct.unpack("<4s4xQQ", head)
    wanted = range(min(count, _MOST_LINKS)) if kind in _LISTS else _DOWN_4.get(kind, ())
    links = _links(stream.read(8 * min(count, _MOST_LINKS)), "Q")
    unpacked = 0
    if kind == b"##DZ":
        unpacked = struct.unpack("<8xQ8x", stream.read(24).ljust(24, b"\0"))[0]
    return [links[i] for i in wanted if i < len(links) and links[i]], unpacked


def _block_3(stream: BinaryIO) -> tuple[list[int], int]:
    kind = stream.read(4)[:2]
    links = _links(stream.read(8), "I")
    return [links[i] for i in _DOWN_3.get(kind, ()) if links[i : i + 1] > [0]], 0


def _links(content: bytes, one: str) -> list[int]:
    whole = len(content) - len(content) % struct.calcsize(one)
    return [link for (link,) in struct.iter_unpack(f"<{one}", content[:whole])]
