"""ASAM MDF measurement files."""

import gc
import logging
import sys
import traceback
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.guards.mdf_blocks import check_blocks, check_claims
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
from tsas_cli.support.memory import out_of_memory

_KINDS = {1: "a time", 2: "an angle", 3: "a distance", 4: "a count"}  # a master's `cn_sync_type`
_MASTER_ELSEWHERE = 8  # of `cg_flags`: the master is that of another group


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
