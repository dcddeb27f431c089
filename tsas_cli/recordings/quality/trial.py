"""One run as the checks see it: channels, their noise and span, and the strokes of the drive."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.columns import TIME, largest
from tsas_cli.recordings.manifest import Rig
from tsas_cli.recordings.quality.outlying import outlying
from tsas_cli.recordings.quality.samples import Booleans, span_of, step_of
from tsas_cli.recordings.recording import Floats, Recording

MECHANICAL = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
_FOLLOWERS = {"spring": MECHANICAL[1:], "force": ("x_out_mm",), "displacement": ()}
_FEWEST = 16  # samples below which neither noise nor motion can be told
_STROKE = 0.2  # of the drive's span: the smallest move back that begins a new stroke


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
class Overall:
    """What a whole run shows of each of its channels, by name."""

    noise: dict[str, float]
    step: dict[str, float]
    span: dict[str, float]
    lowest: dict[str, float]
    highest: dict[str, float]


@dataclass(frozen=True)
class Trial:
    """A recording, and what the data sheet says about the rig.

    Of a long one it is a part, whose first sample is row `first_row`; then `overall` says what the
    whole run shows.
    """

    recording: Recording
    rig: Rig
    overall: Overall | None = None
    first_row: int = 0

    @cached_property
    def time_s(self) -> Floats:
        """Time [s], shape (n,); it may run backwards."""
        return self.recording.time_s

    @cached_property
    def increases(self) -> bool:
        """Whether time increases strictly."""
        return bool((np.diff(self.time_s) > 0).all())

    @cached_property
    def channels(self) -> dict[str, Floats]:
        """The columns besides time that hold enough numbers to say anything about them.

        Samples that stand out are empty in them: they say nothing of the motion.
        """
        return _telling(
            {n: np.where(self.outlying[n], np.nan, v) for n, v in self._recorded.items()}
        )

    @cached_property
    def outlying(self) -> dict[str, Booleans]:
        """Which samples of each channel stand out (`outlying`), shape (n,) each."""
        return {
            name: outlying(
                self.time_s,
                values,
                most=largest(name),
                noise=noise_sd(values) if self.overall is None else self.overall.noise[name],
                step=step_of(values) if self.overall is None else self.overall.step[name],
                span=span_of(values) if self.overall is None else self.overall.span[name],
            )
            for name, values in self._recorded.items()
        }

    @cached_property
    def _recorded(self) -> dict[str, Floats]:
        return _telling({n: v for n, v in self.recording.columns.items() if n != TIME})

    @cached_property
    def mechanical(self) -> dict[str, Floats]:
        """The displacements and tensions among the channels."""
        return {name: self.channels[name] for name in MECHANICAL if name in self.channels}

    @cached_property
    def noise(self) -> dict[str, float]:
        """Sample-to-sample noise of each channel (standard deviation)."""
        if self.overall is not None:
            return self.overall.noise
        return {name: noise_sd(values) for name, values in self.channels.items()}

    @cached_property
    def step(self) -> dict[str, float]:
        """Step of quantisation of each channel, 0 where there is none."""
        if self.overall is not None:
            return self.overall.step
        return {name: step_of(values) for name, values in self.channels.items()}

    @cached_property
    def span(self) -> dict[str, float]:
        """How far each channel moves: all but the outermost thousandth at either end."""
        if self.overall is not None:
            return self.overall.span
        return {name: span_of(values) for name, values in self.channels.items()}

    @cached_property
    def lowest(self) -> dict[str, float]:
        """The lowest value of each channel."""
        if self.overall is not None:
            return self.overall.lowest
        return {name: float(np.nanmin(values)) for name, values in self.channels.items()}

    @cached_property
    def highest(self) -> dict[str, float]:
        """The highest value of each channel."""
        if self.overall is not None:
            return self.overall.highest
        return {name: float(np.nanmax(values)) for name, values in self.channels.items()}

    def visible(self, name: str) -> float:
        """Return the smallest change of a channel that neither noise nor steps explain."""
        return 6.0 * self.noise[name] + 2.0 * self.step[name]

    def moves(self, name: str) -> bool:
        """Return whether a channel moves visibly."""
        return self.span[name] > 2.0 * self.visible(name)

    def references(self, name: str) -> tuple[str, ...]:
        """Return the channels that show the motion beside this one: the drive, or what follows it.

        Those that do not move visibly are left out.
        """
        others = _FOLLOWERS[self.recording.run.load] if name == "x_in_mm" else MECHANICAL[:1]
        return tuple(o for o in others if o in self.channels and self.moves(o))

    @property
    def prescribed(self) -> str | None:
        """The channel that a driven load decides, whatever the drive does."""
        return {"force": "f_out_N", "displacement": "x_out_mm"}.get(self.recording.run.load)

    @cached_property
    def repeats(self) -> Booleans:
        """Which rows equal the row before them in every channel, shape (n,)."""
        same = np.arange(self.time_s.size) > 0
        for values in self.channels.values():
            same[1:] &= values[1:] == values[:-1]
        return same

    @cached_property
    def strokes(self) -> tuple[Stroke, ...]:
        """The strokes of `x_in_mm` that are longer than a fifth of its span; none at rest."""
        x = self.channels.get("x_in_mm")
        if x is None or not self.moves("x_in_mm"):
            return ()
        there = np.flatnonzero(np.isfinite(x))
        threshold = max(_STROKE * self.span["x_in_mm"], self.visible("x_in_mm"))
        turns = there[turning_points(x[there], threshold)]
        return tuple(
            Stroke(int(a), int(b), int(np.sign(x[b] - x[a])))
            for a, b in pairwise(turns)
            if abs(x[b] - x[a]) > threshold
        )

    @cached_property
    def direction(self) -> Floats:
        """1 or −1 where the drive is well under way in a stroke, 0 elsewhere; shape (n,)."""
        direction = np.zeros(self.time_s.size)
        for stroke in self.strokes:
            x = self.channels["x_in_mm"][stroke.rows]
            share = (x - x[0]) / (x[-1] - x[0])
            direction[stroke.rows] = np.where((share > 0.3) & (share < 0.95), stroke.direction, 0)
        return direction

    def follows(self, name: str) -> float | None:
        """Return how a channel goes with the drive's strokes: 1 always with, −1 always against.

        None where it does not move visibly, or there are no strokes.
        """
        values = self.channels[name]
        change = np.array([s.direction * (values[s.stop] - values[s.start]) for s in self.strokes])
        size = np.abs(change)
        if not np.isfinite(size).any() or np.nanmean(size) <= self.visible(name):
            return None
        return float(np.nansum(change) / np.nansum(size))


def _telling(channels: dict[str, Floats]) -> dict[str, Floats]:
    """Return the channels that hold enough numbers to say anything about them."""
    return {n: v for n, v in channels.items() if np.isfinite(v).sum() >= _FEWEST}
