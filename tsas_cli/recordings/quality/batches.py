"""Batches that the rows of a recording come in: a logger stamps them when it is given them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tsas_cli.support.arrays import Floats, Indices

_LONG = 2.5  # times the lower quartile of the intervals
_FEWEST_BATCHES = 5  # batches
_TOGETHER = 0.05  # share of long intervals in a row, beyond which the clock changes its pace
_SLOPE_ROWS = 8  # on each side of a long interval, at most


@dataclass(frozen=True)
class Batches:
    """Rows per batch, the intervals within a batch and between two, and the error of each time.

    `error_s`, shape (n,), is that of the time stamps against times that are spread evenly over
    each batch, without its mean; `row_s` is the interval of the latter.
    """

    rows: int
    within_s: float
    between_s: float
    row_s: float
    error_s: Floats

    def cost(self, values: Floats, noise: float) -> float:
        """Return what the wrong times do to a channel (RMS), in units of its noise."""
        slope = _row_slope(values, np.arange(values.size), self.rows) / self.row_s
        wrong = slope * self.error_s
        wrong = wrong[np.isfinite(wrong)]
        rms = float(np.sqrt(np.mean(wrong**2))) if wrong.size else 0.0
        return rms / noise if noise > 0.0 else 0.0


def batches_of(time_s: Floats, channels: Mapping[str, Floats]) -> Batches | None:
    """Return the batches that a recording's time stamps come in, or None.

    Time does not decrease; the channels are those that move, shape (n,) each.
    """
    interval = np.diff(time_s)
    if interval.size < _FEWEST_BATCHES or bool((interval < 0.0).any()):
        return None
    longs = np.flatnonzero(interval > _LONG * float(np.quantile(interval, 0.25)))
    if longs.size < _FEWEST_BATCHES or float(np.mean(np.diff(longs) == 1)) > _TOGETHER:
        return None
    rows = int(np.median(np.diff(longs)))
    is_long = np.isin(np.arange(interval.size), longs)
    within, between = (float(np.median(interval[at])) for at in (~is_long, is_long))
    moved = [_moved(values, longs, rows) for values in channels.values()]
    if not moved or min(moved) ** 2 * within > between:
        return None
    # Of the last row of each batch, as the first batch and the last one may be cut.
    even = np.interp(np.arange(time_s.size), longs, time_s[longs])
    inside = (np.arange(time_s.size) >= longs[0]) & (np.arange(time_s.size) <= longs[-1])
    error = np.where(inside, time_s - even, 0.0)
    return Batches(
        rows,
        within,
        between,
        float(time_s[longs[-1]] - time_s[longs[0]]) / float(longs[-1] - longs[0]),
        error - float(error[inside].mean()),
    )


def _moved(values: Floats, longs: Indices, rows: int) -> float:
    """Return the change of a channel over the long intervals, in changes from row to row."""
    jump = values[longs + 1] - values[longs]
    slope = _row_slope(values, longs, rows)
    seen = np.isfinite(jump) & np.isfinite(slope)
    size = float(slope[seen] @ slope[seen])
    return abs(float(jump[seen] @ slope[seen])) / size if size > 0.0 else np.inf


def _row_slope(values: Floats, at: Indices, rows: int) -> Floats:
    """Return the change per row before and after some rows, without the step to the next row."""
    reach = min(max(rows - 1, 1), _SLOPE_ROWS)
    before, after = np.maximum(at - reach, 0), np.minimum(at + 1 + reach, values.size - 1)
    here, following = at, np.minimum(at + 1, values.size - 1)
    steps = np.maximum(here - before + after - following, 1)
    return np.asarray((values[here] - values[before] + values[after] - values[following]) / steps)
