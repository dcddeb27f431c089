"""Times: dates and durations in seconds, and channels of different times on one clock."""

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.readers.table import ColumnSource
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

_DATE = re.compile(
    r"(\d{4}[-/]\d\d[-/]\d\d|\d\d\.\d\d\.\d{4})"
    r"([T ]+\d\d:\d\d(:\d\d([.,]\d{1,9})?)?( ?(Z|UTC|[+-]\d\d:?\d\d))?)?"
)
_TIME = re.compile(r"\d{1,4}:\d\d:\d\d([.,]\d{1,9})?")
_DAY_S = 86400.0
LEAST_OVERLAP = 0.5  # of the shortest channel, below which the offset of a clock is wrong
TIME = "time"  # source of the common clock of a file's channels in a map


class Seconds:
    """The conversion of one column to seconds, part by part of a file.

    Dates count from the first one of the file: since 1970 they would be exact to a quarter of a
    microsecond only. Times of day (`from_text`) go on after midnight.
    """

    def __init__(self) -> None:
        self._zero: Any = None
        self._last_s, self._days = 0.0, 0.0

    def __call__(self, values: npt.NDArray[Any]) -> Floats:
        """Return dates or durations in seconds, shape (n,); NaT is NaN."""
        if values.dtype.kind == "M":
            dates = values[~np.isnat(values)]
            if self._zero is None and dates.size:
                self._zero = dates[0]
            values = values - (self._zero if dates.size else values)
        seconds: Floats = values / np.timedelta64(1, "s")
        return seconds

    def from_text(self, cells: Sequence[str | None]) -> Floats:
        """Return cells in seconds, shape (n,); ValueError as from `from_text` of this module."""
        values = from_text(cells)
        seconds = self(values)
        if values.dtype.kind == "M":
            return seconds
        known = np.isfinite(seconds)
        steps = np.diff(seconds[known], prepend=self._last_s)
        days = self._days + np.cumsum(steps < -0.5 * _DAY_S)
        if days.size:
            self._last_s, self._days = float(seconds[known][-1]), float(days[-1])
        whole = np.full(seconds.size, np.nan)
        whole[known] = seconds[known] + _DAY_S * days
        return whole


def on_one_clock(
    series: Mapping[ColumnSource, tuple[Floats, Floats]],
    path: Path,
    *,
    clock_sources: Collection[ColumnSource],
    resample: bool,
) -> dict[ColumnSource, Floats]:
    """Return the channels' values on a common clock, and that clock.

    `series` holds times and values by source, each of shape (n,) with its own n; `clock_sources`
    are those of the clock in the map: `time`, its number, both or none. With `resample`, different
    times are interpolated linearly onto those of the channel with the most samples, within the
    interval that all channels cover.

    InputError: there is no channel; the times differ and `resample` is not set, do not increase, or
    never overlap.
    """
    if not series:
        raise InputError("the map has no channel besides the time", where=path)
    clock = max((times for times, _ in series.values()), key=len)
    if all(np.array_equal(times, clock) for times, _ in series.values()):
        return dict.fromkeys(clock_sources, clock) | {
            s: values for s, (_, values) in series.items()
        }
    described = "; ".join(
        f"{s}: {times.size} samples, {times[0]:g} to {times[-1]:g}"
        if times.size
        else f"{s}: no samples"
        for s, (times, _) in series.items()
    )
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
        steps = np.diff(times)
        invalid = ~((steps > 0) & np.isfinite(steps))  # between which NumPy would interpolate too
        if invalid.any():
            i = int(invalid.argmax())
            raise InputError(
                f"the time of {source} does not increase ({times[i]:.9g}, then {times[i + 1]:.9g})",
                where=f"{path}, row {i + 2}",
                expected="strictly increasing time",
                remedy="correct the file, or leave the channel out",
            )
    start = max(times[0] for times, _ in series.values())
    end = min(times[-1] for times, _ in series.values())
    clock = clock[(clock >= start) & (clock <= end)]
    if clock.size == 0:
        raise InputError(f"the channels never overlap in time ({described})", where=path)
    if end - start < LEAST_OVERLAP * min(times[-1] - times[0] for times, _ in series.values()):
        raise InputError(
            f"the channels overlap for {end - start:.4g} s only ({described})",
            where=path,
            expected="clocks with one beginning",
            remedy="correct the offsets of the clocks, or cut the longer channels",
        )
    resampled = {s: np.interp(clock, *channel) for s, channel in series.items()}
    return dict.fromkeys(clock_sources, clock) | resampled


def is_stamp(text: object) -> bool:
    """Return whether a cell is a date, by ISO 8601 or as DD.MM.YYYY, or a time as hh:mm:ss."""
    return isinstance(text, str) and (_DATE.fullmatch(text) or _TIME.fullmatch(text)) is not None


def from_text(cells: Sequence[str | None]) -> npt.NDArray[Any]:
    """Return cells as datetime64 or timedelta64, shape (n,); an empty cell is NaT.

    ValueError: a cell is no stamp, or is one of another kind than the first.
    """
    import pandas as pd

    plain = pd.Series([cell or None for cell in cells], dtype="object")
    filled = plain.dropna()
    form = _DATE if filled.empty or _DATE.fullmatch(filled.iloc[0]) else _TIME
    if not all(form.fullmatch(cell) for cell in filled):
        raise ValueError("another form of date or time")
    plain = plain.str.replace(r"^(\d\d)\.(\d\d)\.(\d{4})", r"\3-\2-\1", regex=True)
    plain = plain.str.replace(",", ".").str.replace("/", "-").str.replace(" UTC", "Z")
    if form is _TIME:
        return pd.to_timedelta(plain).to_numpy(dtype="timedelta64[ns]")
    return pd.to_datetime(plain, format="ISO8601", utc=True).dt.tz_localize(None).to_numpy()
