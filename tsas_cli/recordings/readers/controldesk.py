"""dSPACE ControlDesk exports: a struct with the clocks in X and the channels in Y."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.table import (
    ColumnSource,
    ColumnTable,
    ReadOptions,
    floats,
    resolve,
)
from tsas_cli.recordings.readers.timebase import TIME, on_one_clock
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError


def find_capture(content: Mapping[str, Any], path: Path) -> Mapping[str, Any] | None:
    """Return the struct that holds X and Y with data, or None.

    Raises
    ------
    InputError
        There are several.
    """
    if _is_capture(content):
        return content
    found = captures(content)
    if len(found) > 1:
        raise InputError(
            f"holds {len(found)} captures: {', '.join(found)}",
            where=path,
            expected="one",
            remedy='name it in the map: table = "…" under [read]',
        )
    return next(iter(found.values()), None)


def captures(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return the captures among the variables, by name."""
    return {name: value for name, value in content.items() if _is_capture(value)}


def channel_names(capture: Mapping[str, Any]) -> list[str]:
    """Return the names of a capture's channels, and of its clock."""
    return [*_names(_records(capture["Y"])), TIME]


def read_capture(
    capture: Mapping[str, Any], options: ReadOptions, wanted: Sequence[ColumnSource], path: Path
) -> ColumnTable:
    """Return the requested channels of a capture; its clock is `time`, in s.

    Raises
    ------
    InputError
        A channel is missing, not numeric, or differs in length from its clock; or the channels'
        clocks differ and the map does not set `resample = true`.
    """
    channels = _records(capture["Y"])
    at = resolve(wanted, [*_names(channels), TIME], path)
    clocks = [floats(np.ravel(clock["Data"]), TIME, path) for clock in _records(capture["X"])]
    clock_sources = [source for source, i in at.items() if i == len(channels)]
    selected = {source: channels[i] for source, i in at.items() if i < len(channels)}
    series = {s: _series(channel, clocks, s, path) for s, channel in selected.items()}
    units = dict.fromkeys(clock_sources, "s")
    units |= {s: unit for s, channel in selected.items() if (unit := str(channel.get("Unit", "")))}
    description = str(capture.get("Description", ""))
    return ColumnTable(
        on_one_clock(series, path, clock_sources=clock_sources, resample=options.resample),
        units,
        (description,) if description else (),
    )


def _names(channels: list[Any]) -> list[str]:
    return [str(channel.get("Name", "")).strip('"') for channel in channels]


def _is_capture(value: Any) -> bool:
    if not isinstance(value, Mapping) or not {"X", "Y"} <= set(value):
        return False
    records = [*_records(value["X"]), *_records(value["Y"])]
    return all(isinstance(record, Mapping) and "Data" in record for record in records)


def _records(value: Any) -> list[Any]:
    """Return a struct array as a list; an array of one element is read as a struct."""
    return list(value) if isinstance(value, list | np.ndarray) else [value]


def _series(
    channel: Mapping[str, Any], clocks: list[Floats], source: ColumnSource, path: Path
) -> tuple[Floats, Floats]:
    values = floats(np.ravel(channel["Data"]), source, path)
    number = channel.get("XIndex", 1)  # number of the clock, from 1
    clock = clocks[int(number) - 1] if np.ndim(number) == 0 and 1 <= number <= len(clocks) else None
    if clock is None or clock.size != values.size:
        raise InputError(
            f"channel {source} has {values.size} samples and no clock of that length", where=path
        )
    return clock, values
