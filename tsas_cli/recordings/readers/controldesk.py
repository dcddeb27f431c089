"""dSPACE ControlDesk exports: a struct with the clocks in X and the channels in Y."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import floats
from tsas_cli.recordings.readers.timebase import TIME
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError


def find_capture(content: Mapping[str, Any], path: Path) -> Mapping[str, Any] | None:
    """Return the struct that holds X and Y with data, or None.

    InputError: there are several.
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


def channels_of(capture: Mapping[str, Any], path: Path) -> Offered:
    """Return the channels of a capture, with their clocks in s.

    InputError: a channel, when it is loaded, differs in length from its clock.
    """
    clocks = [floats(np.ravel(clock["Data"]), TIME, path) for clock in _records(capture["X"])]
    channels = [
        Column(
            str(channel.get("Name", "")).strip('"'),
            partial(np.ravel, channel["Data"]),
            str(channel.get("Unit", "")),
            partial(_clock, channel, clocks, path),
        )
        for channel in _records(capture["Y"])
    ]
    description = str(capture.get("Description", ""))
    return Offered(channels, (description,) if description else ())


def _is_capture(value: Any) -> bool:
    if not isinstance(value, Mapping) or not {"X", "Y"} <= set(value):
        return False
    records = [*_records(value["X"]), *_records(value["Y"])]
    return all(isinstance(record, Mapping) and "Data" in record for record in records)


def _records(value: Any) -> list[Any]:
    """Return a struct array as a list; an array of one element is read as a struct."""
    return list(value) if isinstance(value, list | np.ndarray) else [value]


def _clock(channel: Mapping[str, Any], clocks: list[Floats], path: Path) -> Floats:
    size = np.size(channel["Data"])
    number = channel.get("XIndex", 1)  # number of the clock, from 1
    clock = clocks[int(number) - 1] if np.ndim(number) == 0 and 1 <= number <= len(clocks) else None
    if clock is None or clock.size != size:
        raise InputError(
            f"channel {channel.get('Name', '')} has {size} samples and no clock of that length",
            where=path,
        )
    return clock
