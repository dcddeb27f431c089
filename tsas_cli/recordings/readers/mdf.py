"""ASAM MDF measurement files."""

import gc
import logging
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.errors import InputError
from tsas_cli.memory import out_of_memory
from tsas_cli.recordings.readers.mdf_blocks import check_blocks, check_claims
from tsas_cli.recordings.readers.optional import optional
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Floats, Source, Table, damaged, floats, resolve
from tsas_cli.recordings.readers.timebase import TIME, on_one_clock


def read(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Table:
    """Read the wanted channels of an MDF file; its master channel is `time`, in s.

    Raises
    ------
    InputError
        asammdf is not installed, the file is damaged, a channel is missing or holds no numbers,
        or the channels' times differ and the map does not say `resample = true`.
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
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)  # it logs what our error says
    check_blocks(path)
    try:
        with asammdf.MDF(path) as file:
            yield file
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except Exception as error:  # a damaged file ends in any of a dozen types
        _discard_half_made(error)
        raise damaged(path, "MDF", error) from error


def _discard_half_made(error: Exception) -> None:
    """Collect what a damaged file left behind now: asammdf's clean-up of it fails on stderr."""
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    traceback.clear_frames(error.__traceback__)
    gc.collect()
    sys.unraisablehook = hook


def _table(file: Any, options: ReadOptions, wanted: Sequence[Source], path: Path) -> Table:
    channels = _channels(file)
    at = resolve(wanted, [*(name for name, _, _ in channels), TIME], path)
    groups = (channels[i][1] for i in at.values() if i < len(channels))
    check_claims(path, (file.groups[group].channel_group.cycles_nr for group in groups))
    signals = {
        source: file.get(*channels[i], ignore_invalidation_bits=True)
        for source, i in at.items()
        if i < len(channels)
    }
    series = {s: (signal.timestamps, _values(signal, s, path)) for s, signal in signals.items()}
    columns = on_one_clock(series, path, resample=options.resample)
    units: dict[Source, str] = {TIME: "s"}
    units |= {source: signal.unit for source, signal in signals.items() if signal.unit}
    header = (str(file.header.comment), f"started {file.start_time.isoformat()}")
    return Table(columns, units, header)


def _channels(file: Any) -> list[tuple[str, int, int]]:
    """Return name, group and index of every channel that is no master."""
    return [
        (channel.name, group, index)
        for group, content in enumerate(file.groups)
        for index, channel in enumerate(content.channels)
        if index != file.masters_db.get(group)
    ]


def _values(signal: Any, source: Source, path: Path) -> Floats:
    """Return a channel's samples; those that the file marks as invalid are gaps."""
    values = floats(signal.samples, source, path).copy()
    if signal.invalidation_bits is not None:
        values[np.asarray(signal.invalidation_bits, dtype=bool)] = np.nan
    return values
