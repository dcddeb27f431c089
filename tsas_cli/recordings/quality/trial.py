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
from tsas_cli.recordings.quality.batches import Batches, batches_of
from tsas_cli.recordings.quality.samples import Size, alternates, outlying, size_of
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.arrays import Floats, Indices, Mask

GAP = 1.5  # intervals; a longer one is a gap
COMMANDED = "motor_speed_rpm"
MECHANICAL = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
_FOLLOWERS = {"spring": MECHANICAL[1:], "force": ("x_out_mm",), "displacement": ()}
_STEPS, _ROUNDING = 2.0, 1e-5  # of a step, and of the span: the least noise of a sensor
FEWEST = 16  # samples of a channel that is checked
_SMALL_OFFSET = 0.02  # of a tension's range
_STROKE = 0.2  # of the drive's span: the smallest reversal that begins a new stroke


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
        sizes = self.overall or self._sizes_of(self._recorded)
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
        return self.overall or self._sizes_of(self.channels)

    def _sizes_of(self, channels: Mapping[str, Floats]) -> dict[str, Size]:
        return {name: size_of(values, self.time_s) for name, values in channels.items()}

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

    def reading_of_none(self, name: str) -> float:
        """Return the largest size that a sensor with a small offset reads of no tension [N]."""
        return max(self.visible(name), _SMALL_OFFSET * self.sizes[name].span)

    def is_slack(self, rows: slice | Indices) -> bool:
        """Return whether a recorded tension vanishes in these rows, as of a slack tendon."""
        tensions = [name for name in self.mechanical if name.startswith("f_")]
        return any(
            bool(np.all(np.abs(self.channels[name][rows]) <= self.reading_of_none(name)))
            for name in tensions
        )

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
    return {n: v for n, v in channels.items() if np.isfinite(v).sum() >= FEWEST}
