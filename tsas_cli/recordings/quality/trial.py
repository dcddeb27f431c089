"""One run for the checks: its channels, their noise and span, and the strokes of the drive."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.columns import TIME, largest
from tsas_cli.recordings.manifest import RigSheet
from tsas_cli.recordings.quality.samples import Size, alternates, outlying, size_of
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.arrays import Floats, Indices, Mask

GAP = 1.5  # intervals; a longer one is a gap
_LONG = 2.5  # times the lower quartile of the intervals
_FEWEST_BATCHES = 5  # batches
_TOGETHER = 0.05  # share of long intervals in a row, beyond which the clock changes its pace
_SLOPE_ROWS = 8  # on each side of a long interval, at most
COMMANDED = "motor_speed_rpm"
MECHANICAL = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
_FOLLOWERS = {"spring": MECHANICAL[1:], "force": ("x_out_mm",), "displacement": ()}
_STEPS, _ROUNDING = 2.0, 1e-5  # of a step, and of the span: the least noise of a sensor
_FEWEST = 16  # samples of a channel that is checked
_STROKE = 0.2  # of the drive's span: the smallest reversal that begins a new stroke


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


@dataclass(frozen=True)
class Stroke:
    """A move of the drive in one direction, from one row to another, both included."""

    start: int
    stop: int
    direction: int

    @property
    def rows(self) -> slice:
        """The rows of the stroke."""
        return slice(self.start, self.stop + 1)


@dataclass(frozen=True)
class RunSignals:
    """A recording, and the data sheet of the rig.

    It may be a part of a long run from row `first_row` on; `overall` then holds the size of each
    channel over the whole run.
    """

    recording: Recording
    rig: RigSheet
    overall: Mapping[str, Size] | None = None
    first_row: int = 0

    @cached_property
    def time_s(self) -> Floats:
        """Time [s], shape (n,); it may decrease."""
        return self.recording.time_s

    @cached_property
    def increases(self) -> bool:
        """Whether time increases strictly."""
        return bool((np.diff(self.time_s) > 0).all())

    @cached_property
    def step_s(self) -> float:
        """The median time between two samples [s]."""
        return float(np.median(np.diff(self.time_s)))

    @cached_property
    def channels(self) -> dict[str, Floats]:
        """The columns besides time that hold enough values, with outliers as NaN."""
        return _with_enough_values(
            {n: np.where(self.outlying[n], np.nan, v) for n, v in self._recorded.items()}
        )

    @cached_property
    def outlying(self) -> dict[str, Mask]:
        """Which samples of each channel are outliers (`outlying`), shape (n,) each.

        A commanded speed may jump for a sample or two: there only implausible values are.
        """
        sizes = self.overall or {name: size_of(values) for name, values in self._recorded.items()}
        return {
            name: np.abs(values) > largest(name)
            if name == COMMANDED
            else outlying(self.time_s, values, sizes[name], most=largest(name))
            for name, values in self._recorded.items()
        }

    @cached_property
    def _recorded(self) -> dict[str, Floats]:
        return _with_enough_values({n: v for n, v in self.recording.columns.items() if n != TIME})

    @cached_property
    def mechanical(self) -> dict[str, Floats]:
        """The displacements and tensions among the channels."""
        return {name: self.channels[name] for name in MECHANICAL if name in self.channels}

    @cached_property
    def noisy(self) -> dict[str, Floats]:
        """The displacements and tensions with noise of a sensor, and without a gap."""
        return {
            name: values
            for name, values in self.mechanical.items()
            if self.is_noisy(name) and np.isfinite(values).all()
        }

    @cached_property
    def sizes(self) -> Mapping[str, Size]:
        """The size of each channel over the whole run, by name."""
        return self.overall or {name: size_of(values) for name, values in self.channels.items()}

    @cached_property
    def batches(self) -> Batches | None:
        """The batches that the time stamps come in, seen by the channels that move; or None."""
        moving = {name: v for name, v in self.mechanical.items() if self.moves(name)}
        return batches_of(self.time_s, moving)

    @property
    def unbatched(self) -> bool:
        """Whether the rows come one by one."""
        return self.batches is None

    def visible(self, name: str) -> float:
        """Return the smallest change of a channel that neither noise nor quantisation explains."""
        return 6.0 * self.sizes[name].noise + 2.0 * self.sizes[name].step

    def moves(self, name: str) -> bool:
        """Return whether a channel moves visibly."""
        return self.sizes[name].span > 2.0 * self.visible(name)

    def is_noisy(self, name: str) -> bool:
        """Return whether a channel has noise of a sensor: beyond its steps, and no rounding."""
        size = self.sizes[name]
        least = max(_STEPS * size.step, _ROUNDING * size.span)
        return size.noise > least and alternates(self.channels[name])

    def references(self, name: str) -> tuple[str, ...]:
        """Return the other channels that show the motion: the drive, or its followers.

        Those that do not move visibly are left out.
        """
        others = _FOLLOWERS[self.recording.run.load] if name == "x_in_mm" else MECHANICAL[:1]
        return tuple(o for o in others if o in self.channels and self.moves(o))

    def steps(self, name: str) -> Floats:
        """Return the size of a channel's changes from row to row, 0 over a gap, shape (n - 1,)."""
        sizes = np.nan_to_num(np.abs(np.diff(self.channels[name])))
        return np.where(np.diff(self.time_s) > GAP * self.step_s, 0.0, sizes)

    @property
    def prescribed(self) -> str | None:
        """The channel that a driven load prescribes, whatever the drive does."""
        return {"force": "f_out_N", "displacement": "x_out_mm"}.get(self.recording.run.load)

    @property
    def on_spring(self) -> bool:
        """Whether the load is a spring, so that the distal end follows the drive."""
        return self.recording.run.load == "spring"

    @cached_property
    def repeats(self) -> Mask:
        """Which rows equal the row before them in every channel, shape (n,)."""
        same = np.arange(self.time_s.size) > 0
        for values in self.channels.values():
            same[1:] &= values[1:] == values[:-1]
        return same

    @cached_property
    def strokes(self) -> tuple[Stroke, ...]:
        """The strokes of `x_in_mm` that are longer than a fifth of its span; none at rest.

        A smaller motion before the first or after the last reversal is not part of a stroke: the
        friction of the tendon changes over it as over a whole one.
        """
        x = self.channels.get("x_in_mm")
        if x is None or not self.moves("x_in_mm"):
            return ()
        valid = np.flatnonzero(np.isfinite(x))
        threshold = max(_STROKE * self.sizes["x_in_mm"].span, self.visible("x_in_mm"))
        reversals = valid[turning_points(x[valid], threshold)]
        return tuple(
            self._between_extremes(Stroke(int(a), int(b), int(np.sign(x[b] - x[a]))))
            for a, b in pairwise(reversals)
            if abs(x[b] - x[a]) > threshold
        )

    def _between_extremes(self, stroke: Stroke) -> Stroke:
        """Return a stroke from its lowest to its highest place, where its ends are visibly off."""
        along = stroke.direction * self.channels["x_in_mm"][stroke.rows]
        visible = self.visible("x_in_mm")
        first, last = int(np.nanargmin(along)), int(np.nanargmax(along))
        start = stroke.start + first if along[0] - along[first] > visible else stroke.start
        stop = stroke.start + last if along[last] - along[-1] > visible else stroke.stop
        return replace(stroke, start=start, stop=stop)

    @cached_property
    def stroke_s(self) -> float:
        """The median time of a stroke [s]; NaN without one."""
        lasted_s = [self.time_s[s.stop] - self.time_s[s.start] for s in self.strokes]
        return float(np.median(lasted_s)) if lasted_s else math.nan

    @cached_property
    def direction(self) -> Floats:
        """Sign of the stroke from 30 % to 95 % of its travel, 0 elsewhere; shape (n,)."""
        direction = np.zeros(self.time_s.size)
        for stroke in self.strokes:
            x = self.channels["x_in_mm"][stroke.rows]
            share = (x - x[0]) / (x[-1] - x[0])
            direction[stroke.rows] = np.where((share > 0.3) & (share < 0.95), stroke.direction, 0)
        return direction

    def follows(self, name: str) -> float | None:
        """Return the agreement of a channel with the drive's strokes: 1 (same) to −1 (opposite).

        None if it does not move visibly, or there are no strokes.
        """
        values = self.channels[name]
        change = np.array([s.direction * (values[s.stop] - values[s.start]) for s in self.strokes])
        size = np.abs(change)
        if not np.isfinite(size).any() or np.nanmean(size) <= self.visible(name):
            return None
        return float(np.nansum(change) / np.nansum(size))


def _with_enough_values(channels: dict[str, Floats]) -> dict[str, Floats]:
    return {n: v for n, v in channels.items() if np.isfinite(v).sum() >= _FEWEST}


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
