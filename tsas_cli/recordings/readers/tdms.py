"""TDMS files of LabVIEW."""

from collections.abc import Iterator
from functools import partial
from operator import getitem
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import ReadOptions, optional
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the channels by name, as `group/name` if there are several groups.

    Where channels state their sample interval, `time` is their common clock.
    """
    nptdms = optional("nptdms", extra="tdms")
    with nptdms.TdmsFile.open(path) as file:
        groups = [group for group in file.groups() if group.channels()]
        channels = [c for group in groups for c in group.channels()]
        channels = [
            c for c in channels if c.dtype is not None and np.dtype(c.dtype).kind in "fiubM"
        ]
        starts = [start for c in channels if (start := c.properties.get("wf_start_time"))]
        columns = [
            Column(
                channel.name if len(groups) == 1 else f"{channel.group_name}/{channel.name}",
                partial(getitem, channel, slice(None)),
                str(channel.properties.get("unit_string", "")),
                partial(_times, channel, min(starts, default=None))
                if channel.properties.get("wf_increment")
                else None,
            )
            for channel in channels
        ]
        said = {k: v for k, v in file.properties.items() if isinstance(v, str | float | int)}
        if not columns:
            raise InputError("holds no channel of numbers", where=path)
        yield Offered(columns, tuple(f"{key} = {value}" for key, value in said.items()))


def _times(channel: Any, first: Any) -> Floats:
    """Return the clock of a channel [s], shape (n,), since the start of the first channel."""
    said = channel.properties
    start_s = (said.get("wf_start_time", first) - first) / np.timedelta64(1, "s") if first else 0.0
    offset_s = float(said.get("wf_start_offset", 0.0)) + float(start_s)
    times: Floats = offset_s + float(said["wf_increment"]) * np.arange(
        len(channel), dtype=np.float64
    )
    return times
