"""ASAM MDF measurement files."""

import gc
import logging
import struct
import sys
import traceback
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.guards.expansion import Expanded
from tsas_cli.recordings.readers.table import (
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    optional,
    resolve,
)
from tsas_cli.recordings.readers.timebase import TIME, on_one_clock
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.limits import out_of_memory

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


class _Block(NamedTuple):
    kind: bytes
    down: tuple[int, ...]
    unpacked: int


def read(path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]) -> ColumnTable:
    """Return the requested channels of an MDF file; its master channel is `time`.

    InputError: asammdf is not installed, the file is damaged, a channel is missing or not numeric,
    the master is requested but no time, or the channels' masters differ and cannot be resampled (no
    times in one unit, or the map does not set `resample = true`).
    """
    with _opened(path) as file:
        return _table(file, options, wanted, path)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the channels; the master is the last."""
    del options
    with _opened(path) as file:
        return [*(name for name, _, _ in _channels(file)), TIME]


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    asammdf = optional("asammdf", extra="mdf")
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)  # our error repeats its log
    check_blocks(path)
    try:
        with asammdf.MDF(path) as file:
            yield file
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except Exception as error:  # a damaged file raises any of a dozen types
        _discard_half_made(error)
        raise damaged(path, "MDF", error) from error


def _discard_half_made(error: Exception) -> None:
    """Collect the half-made objects of a damaged file, whose clean-up prints errors to stderr."""
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    traceback.clear_frames(error.__traceback__)
    gc.collect()
    sys.unraisablehook = hook


def _table(
    file: Any, options: ReadOptions, wanted: Sequence[ColumnSource], path: Path
) -> ColumnTable:
    channels = _channels(file)
    at = resolve(wanted, [*(name for name, _, _ in channels), TIME], path)
    groups = [channels[i][1] for i in at.values() if i < len(channels)]
    check_claims(path, (file.groups[group].channel_group.cycles_nr for group in groups))
    clock_sources = [source for source, i in at.items() if i == len(channels)]
    clock_unit = _clock_unit(file, groups, path, is_requested=bool(clock_sources))
    signals = {
        source: file.get(*channels[i], ignore_invalidation_bits=True)
        for source, i in at.items()
        if i < len(channels)
    }
    series = {s: (signal.timestamps, _values(signal, s, path)) for s, signal in signals.items()}
    columns = on_one_clock(series, path, clock_sources=clock_sources, resample=options.resample)
    units = dict.fromkeys(clock_sources, clock_unit)
    units |= {source: signal.unit for source, signal in signals.items() if signal.unit}
    header = (str(file.header.comment), f"started {file.start_time.isoformat()}")
    return ColumnTable(columns, units, header)


def _channels(file: Any) -> list[tuple[str, int, int]]:
    """Return name, group and index of every channel that is no master."""
    return [
        (channel.name, group, index)
        for group, content in enumerate(file.groups)
        for index, channel in enumerate(content.channels)
        if index != file.masters_db.get(group)
    ]


def _clock_unit(file: Any, groups: Iterable[int], path: Path, *, is_requested: bool) -> str:
    """Return the unit of the groups' master, which has to be a time if it is requested."""
    clocks = list(dict.fromkeys(_clock(file, group) for group in groups)) or [("a time", "s")]
    described = ", ".join(f"{kind} in {unit}" for kind, unit in clocks)
    if len(clocks) > 1 or (is_requested and clocks[0][0] != "a time"):
        raise InputError(
            f"the clock of the channels is {described}",
            where=path,
            expected="a time, in one unit",
            remedy="map channels of one group; one without a time needs rate_Hz in the map",
        )
    return clocks[0][1]


def _clock(file: Any, group: int) -> tuple[str, str]:
    """Return the kind and the unit of a group's master; the default of a time is seconds."""
    of_group = file.groups[group].channel_group
    if getattr(of_group, "flags", 0) & _MASTER_ELSEWHERE:
        return _clock(file, of_group.cg_master_index)
    index = file.masters_db.get(group)
    if index is None:
        return "a count", "samples"
    master = file.groups[group].channels[index]
    kind = _KINDS.get(getattr(master, "sync_type", 1), "nothing")  # MDF 3 has times only
    return kind, str(file.get_channel_unit(group=group, index=index)).strip() or "s"


def _values(signal: Any, source: ColumnSource, path: Path) -> Floats:
    """Return a channel's samples; those marked as invalid are NaN."""
    values = floats(signal.samples, source, path).copy()
    if signal.invalidation_bits is not None:
        values[np.asarray(signal.invalidation_bits, dtype=bool)] = np.nan
    return values


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
