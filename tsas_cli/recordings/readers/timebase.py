"""Channels with different times, interpolated onto one clock."""

from collections.abc import Collection, Mapping
from pathlib import Path

import numpy as np

from tsas_cli.recordings.readers.table import ColumnSource
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

TIME = "time"  # source of the common clock of a file's channels in a map


def on_one_clock(
    series: Mapping[ColumnSource, tuple[Floats, Floats]],
    path: Path,
    *,
    clock_sources: Collection[ColumnSource],
    resample: bool,
) -> dict[ColumnSource, Floats]:
    """Return the channels' values on a common clock, and that clock.

    Parameters
    ----------
    series
        Times and values by source, each of shape (n,) with its own n.
    clock_sources
        The sources of the clock in the map: `time`, its number, both or none.
    resample
        Interpolate different times linearly onto those of the channel with the most samples,
        within the interval that all channels cover.

    Raises
    ------
    InputError
        There is no channel; the times differ and `resample` is not set, do not increase, or never
        overlap.
    """
    if not series:
        raise InputError("the map has no channel besides the time", where=path)
    clock = max((times for times, _ in series.values()), key=len)
    if all(np.array_equal(times, clock) for times, _ in series.values()):
        return dict.fromkeys(clock_sources, clock) | {
            s: values for s, (_, values) in series.items()
        }
    described = "; ".join(f"{s}: {_described(times)}" for s, (times, _) in series.items())
    if not resample:
        raise InputError(
            f"the channels have different times ({described})",
            where=path,
            expected="one clock",
            remedy="map channels of one raster, or interpolate: resample = true under [read]",
        )
    if any(times.size == 0 for times, _ in series.values()):
        raise InputError(f"a channel holds no samples ({described})", where=path)
    for source, (times, _) in series.items():
        _check_increases(times, source, path)
    start = max(times[0] for times, _ in series.values())
    end = min(times[-1] for times, _ in series.values())
    clock = clock[(clock >= start) & (clock <= end)]
    if clock.size == 0:
        raise InputError(f"the channels never overlap in time ({described})", where=path)
    resampled = {s: np.interp(clock, *channel) for s, channel in series.items()}
    return dict.fromkeys(clock_sources, clock) | resampled


def _check_increases(times: Floats, source: ColumnSource, path: Path) -> None:
    """Refuse times that do not increase: NumPy would interpolate between them without an error."""
    steps = np.diff(times)
    invalid = ~((steps > 0) & np.isfinite(steps))
    if invalid.any():
        i = int(invalid.argmax())
        raise InputError(
            f"the time of {source} does not increase ({times[i]:.9g}, then {times[i + 1]:.9g})",
            where=f"{path}, row {i + 2}",
            expected="strictly increasing time",
            remedy="correct the file, or leave the channel out",
        )


def _described(times: Floats) -> str:
    if times.size == 0:
        return "no samples"
    return f"{times.size} samples, {times[0]:g} to {times[-1]:g}"
