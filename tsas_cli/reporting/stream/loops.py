"""A tension over the displacement of the drive: the whole loop, and where the run is in it.

The measured loop has the colours of its phases, those of the models lie over it. Both are thinned
to what a screen shows; the series are not. In the viewer's plane scales are equal and y points
downwards: the ranges are scaled to a frame, and ticks say what they were.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
import numpy.typing as npt
import rerun as rr
import rerun.blueprint as rrb

from tsas_cli.reporting.channels import at_axis, in_words
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.drawing import kept_samples
from tsas_cli.reporting.numbers import as_printed
from tsas_cli.reporting.phases import BY_KEY, phase_of_samples
from tsas_cli.reporting.stream.recorder import Entity, Recorder, path_of
from tsas_cli.reporting.stream.seen import MEASURED, X_IN, Channel, SeenRun
from tsas_cli.support.arrays import Floats, Indices

POINTS, MOMENTS = 10_000, 4000  # about how many the loop has, and its moving point
WIDTH, HEIGHT, MARGIN, TICK = 1.7, 1.0, 0.04, 0.015  # of the frame
_SEEN = rrb.VisualBounds2D(x_range=(-0.2, WIDTH + 0.08), y_range=(-HEIGHT - 0.12, 0.2))


@dataclass(frozen=True)
class Axis:
    """One axis: its range, drawn from 0 to `end`."""

    low: float
    high: float
    end: float

    def place(self, values: Floats) -> Floats:
        """Return where values stand."""
        return (values - self.low) / (self.high - self.low) * self.end

    def ticks(self) -> Floats:
        """Return round numbers within the range."""
        from matplotlib.ticker import MaxNLocator

        found = np.asarray(MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(self.low, self.high))
        return found[(found >= self.low) & (found <= self.high)]


def axis_of(values: Floats, end: float) -> Axis:
    """Return the axis of values, NaN for gaps; there must be one."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = MARGIN * ((high - low) or abs(high) or 1.0)
    return Axis(low - room, high + room, end)


@dataclass(frozen=True)
class LoopPlane:
    """The plane of one loop of a run, and the samples of which it is drawn."""

    recorder: Recorder
    run: SeenRun
    entity: Entity
    x: Axis
    y: Axis
    kept: Indices
    moments: Indices

    @classmethod
    def of(
        cls, recorder: Recorder, run: SeenRun, channel: Channel, measured: Floats
    ) -> Self | None:
        """Record axes and measured loop, shape (n,); None where there is no point of it."""
        x, there = run.x_in_mm, np.isfinite(run.x_in_mm + measured)
        if not there.any():
            return None
        axes = axis_of(x[there], WIDTH), axis_of(measured[there], -HEIGHT)
        points = (kept_samples(x, measured, points=most) for most in (POINTS, MOMENTS))
        loop = cls(recorder, run, run.entity(channel.column, "loop"), *axes, *points)
        loop._record_axes(at_axis(X_IN), at_axis(channel.column))
        loop.record(MEASURED, measured, dark("ink"), order=1.0)
        return loop

    def record(self, key: str, y: Floats, colour: int, *, order: float) -> None:
        """Record a curve over the measured displacement, shape (n,), and its moving point.

        What has a higher order lies on top, and is thinner.
        """
        places = self._places(self.kept, y)
        phases = np.full(len(places), key, dtype=object)
        if key == MEASURED:
            phases = phase_of_samples(self.run.time_s[self.kept], self.run.segments)
        found = list(_strips(places, phases))
        shades = [dark(BY_KEY[p].colour) if p in BY_KEY else colour for p, _ in found]
        strips = [strip for _, strip in found]
        look = rr.LineStrips2D(strips, colors=shades, radii=-2.0 / order, draw_order=order)
        self.recorder.static((*self.entity, key), look)
        now = (*self.entity, key, "now")
        style = rr.Points2D.from_fields(
            colors=colour, radii=-6.0 / order**0.5, draw_order=order + 9.0
        )
        self.recorder.static(now, style)
        places = self._places(self.moments, y)
        there = np.flatnonzero(np.isfinite(places).all(axis=1))
        times = self.run.times.at(self.moments[there])
        self.recorder.columns(now, times, rr.Points2D.columns(positions=places[there]))

    def _places(self, at: Indices, y: Floats) -> Floats:
        return np.column_stack((self.x.place(self.run.x_in_mm[at]), self.y.place(y[at])))

    def _record_axes(self, x_label: str, y_label: str) -> None:
        across, up = self.x.ticks(), self.y.ticks()
        at_x, at_y = self.x.place(across), self.y.place(up)
        lines = [[[0.0, -HEIGHT], [0.0, 0.0], [WIDTH, 0.0]]]
        lines += [[[at, 0.0], [at, TICK]] for at in at_x]
        lines += [[[-TICK, at], [0.0, at]] for at in at_y]
        look = rr.LineStrips2D(lines, colors=dark("muted"), radii=-0.6, draw_order=-1.0)
        self.recorder.static((*self.entity, "axes"), look)
        places = [*((at, 0.02) for at in at_x), *((-0.1, at - 0.04) for at in at_y)]
        places += [(0.5 * WIDTH, 0.14), (0.35 * WIDTH, -HEIGHT - 0.06)]
        labels = [*map(as_printed, (*across, *up)), x_label, y_label]
        names = rr.Points2D(places, labels=labels, colors=dark("ink"), radii=0.0, show_labels=True)
        self.recorder.static((*self.entity, "names"), names)


def view_of(run: SeenRun, channel: Channel, titled: str = "") -> rrb.View:
    """Return the view of a loop; `titled` names it where it does not stand with its run."""
    name = f"{in_words(channel.column)} over displacement"
    return rrb.Spatial2DView(
        name=f"{titled}: {name}" if titled else name,
        contents=f"+ {path_of(run.entity(channel.column, 'loop'))}/**",
        visual_bounds=_SEEN,
    )


def _strips(places: Floats, labels: npt.NDArray[np.object_]) -> Iterator[tuple[str, Floats]]:
    """Yield each stretch of one label, up to the next one's first point, but over no gap."""
    there = np.atleast_1d(np.isfinite(places).all(axis=1))
    labels = np.where(there, labels, "")
    edges = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1), len(labels)]
    for first, end in pairwise(edges):
        if labels[first]:
            yield labels[first], places[first : end + int(end < len(labels) and there[end])]
