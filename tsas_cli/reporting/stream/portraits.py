"""A tension over the displacement of the drive: the whole loop, and where the run is in it.

The loop stands faint in the colours of its phases; its last stretch runs along, measured and as
the models answer it. Curves and moments are thinned to what a screen shows; the series are not.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import rerun as rr
from rerun.blueprint import View

from tsas_cli.reporting.channels import at_axis, in_words
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.decimation import Indices, kept_samples
from tsas_cli.reporting.phases import PHASES, Phase, phase_of_samples
from tsas_cli.reporting.stream.events import reversals
from tsas_cli.reporting.stream.plane import Frame, frame_of, plane_view, record_frame
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.seen import MEASURED, X_IN, Channel, SeenRun
from tsas_cli.reporting.stream.sources import StreamSource

Floats = npt.NDArray[np.float64]

POINTS, MOMENTS = 10_000, 4000  # about how many the loop has, and its moving point
PART, USUAL_S = 0.3, 1.0  # of a stroke, and where no stroke is known: what runs along
FAINT = 0x70
_TRAIL_RADIUS, _NOW_RADIUS = 2.0, 6.0  # in points of the screen
LOOP, TRAIL, NOW = "loop", "trail", "now"


@dataclass(frozen=True)
class Portrait:
    """One loop of one run; x and y are its measured columns, shape (n,), NaN for gaps."""

    run: SeenRun
    channel: Channel
    x: Floats
    y: Floats

    @cached_property
    def there(self) -> npt.NDArray[np.bool_]:
        """Where both were measured."""
        return np.isfinite(self.x) & np.isfinite(self.y)

    @cached_property
    def frame(self) -> Frame:
        """The axes."""
        return frame_of(self.x[self.there], self.y[self.there])

    @cached_property
    def moments(self) -> Indices:
        """The samples at which the moving point stands."""
        return kept_samples(self.x, self.y, points=MOMENTS)

    def record(self, recorder: Recorder) -> None:
        """Record the axes, the loop in the colours of its phases, and the measured stretch."""
        if not self.there.any():
            return
        names = at_axis(X_IN), at_axis(self.channel.column)
        record_frame(recorder, self._entity(), self.frame, names, "ink")
        for phase, curves in self._by_phase():
            shade = dark(phase.colour, FAINT)
            look = rr.LineStrips2D(curves, colors=shade, radii=-1.0, draw_order=0.0)
            recorder.static(self._entity("phase", phase.key), look)
        self._record_stretch(recorder, MEASURED, self.y, dark("ink"), place=0)

    def record_prediction(self, recorder: Recorder, source: StreamSource, values: Floats) -> None:
        """Record the stretch that a model answers, shape (n,), over the measured displacement."""
        if self.there.any():
            place, which = 1 + self.channel.sources.index(source), source.which
            self._record_stretch(recorder, which.key, values, dark(which.role), place)

    def _record_stretch(
        self, recorder: Recorder, key: str, values: Floats, shown: int, place: int
    ) -> None:
        """Record a stretch that runs along; those with a later place are thinner and on top."""
        at, size, order = self.moments, 1.0 / (1.0 + 0.5 * place), 1.0 + 2.0 * place
        times = self.run.at(self.run.time_s[at])
        places = self.frame.place(self.x[at], values[at])
        pieces = np.stack((places[:-1], places[1:]), axis=1)
        joined = np.isfinite(pieces).all(axis=(1, 2))
        recorder.segments_2d(
            self._entity(TRAIL, key),
            times.at(1 + np.flatnonzero(joined)),
            pieces[joined],
            shown,
            radius=-_TRAIL_RADIUS * size,
            order=order,
        )
        there = np.flatnonzero(np.isfinite(places).all(axis=1))
        recorder.points_2d(
            self._entity(NOW, key),
            times.at(there),
            places[there],
            shown,
            radius=-_NOW_RADIUS * size,
            order=order + 1.0,
        )

    def _by_phase(self) -> Iterator[tuple[Phase, list[Floats]]]:
        """Yield each phase with its stretches, thinned, up to the first point of the next one."""
        time_s, x, y = (values[self.there] for values in (self.run.time_s, self.x, self.y))
        begun = np.searchsorted(time_s, [segment.start_s for segment in self.run.segments])
        kept = np.union1d(kept_samples(x, y, points=POINTS), begun[begun < x.size])
        kept = kept.astype(np.int64)
        phase = phase_of_samples(time_s[kept], self.run.segments)
        places = self.frame.place(x[kept], y[kept])
        edges = [0, *(np.flatnonzero(phase[1:] != phase[:-1]) + 1), phase.size]
        stretches = [(phase[first], places[first : end + 1]) for first, end in pairwise(edges)]
        for one in PHASES:
            if curves := [curve for key, curve in stretches if key == one.key]:
                yield one, curves

    def _entity(self, *parts: str) -> Entity:
        return self.run.entity(self.channel.column, LOOP, *parts)


def view_of(run: SeenRun, channel: Channel, titled: str = "") -> View:
    """Return the view of a loop; `titled` names it where it does not stand with its run."""
    base = run.entity(channel.column, LOOP)
    keys = (MEASURED, *(source.which.key for source in channel.sources))
    stretch = stretch_s(run)
    name = f"{in_words(channel.column)} over displacement"
    trails = {(*base, TRAIL, key): stretch for key in keys}
    return plane_view(f"{titled}: {name}" if titled else name, base, trails)


def stretch_s(run: SeenRun) -> float:
    """Return how long the stretch is that runs along the loop [s]."""
    turns = [at_s for at_s, _ in reversals(run.segments)]
    return PART * float(np.median(np.diff(turns))) if len(turns) > 1 else USUAL_S
