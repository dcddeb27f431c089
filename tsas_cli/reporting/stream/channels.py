"""A run over time: channels, predictions, residuals, phases, faults.

A column of a file is read once, recorded, and forgotten. A loop is thinned to what a screen shows,
the series are not. In the viewer's plane scales are equal and y points downwards: the ranges are
scaled to a frame, and ticks say what they were.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
import numpy.typing as npt
import rerun as rr
import rerun.blueprint as rrb

from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.colours import dark, role_of_controller
from tsas_cli.reporting.drawing import kept_samples
from tsas_cli.reporting.names import (
    PHASES,
    X_IN,
    at_axis,
    in_words,
    label_of,
    phase_of_samples,
    role_of_phase,
)
from tsas_cli.reporting.numbers import as_printed
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.seen import MEASURED, RESIDUAL, WANTED, Channel, SeenRun
from tsas_cli.reporting.tracking import runs as tracked
from tsas_cli.support.arrays import Floats, Indices

POINTS, MOMENTS = 10_000, 4000  # about how many the loop has, and its moving point
WIDTH, HEIGHT, MARGIN, TICK = 1.7, 1.0, 0.04, 0.015  # of the frame
_SEEN = rrb.VisualBounds2D(x_range=(-0.2, WIDTH + 0.08), y_range=(-HEIGHT - 0.12, 0.2))
_LEVELS = {"error": "ERROR", "warning": "WARN"}
FORCE, ERROR, SPEED = "f_out_N", "tracking_error_N", "motor_speed_rpm"
STATES = {  # that a controller keeps: the axis of each column
    "error_sum_mm_s": "sum of the error ∫e dt [mm s]",
    "sliding_distance_mm_per_s2": "sliding variable s [mm/s²]",
    "phi1_rpm_s3_per_mm": "estimate φ̂1 [rpm s³/mm]",
    "phi2_rpm_s_per_mm": "estimate φ̂2 [rpm s/mm]",
    "phi3_rpm_s2_per_mm": "estimate φ̂3 [rpm s²/mm]",
    "error_estimate_mm": "estimated error [mm]",
    "disturbance_rpm": "estimated disturbance d [rpm]",
}
_ROLES = {MEASURED: "measured", WANTED: "ink"}
_WIDTHS = {MEASURED: 2.5, WANTED: 1.5}  # what is measured shows under what covers it


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


@dataclass(frozen=True)
class LoopPlane:
    """The plane of one loop of a run, and the samples of which it is drawn."""

    recorder: Recorder
    run: SeenRun
    entity: str
    x: Axis
    y: Axis
    kept: Indices
    moments: Indices

    @classmethod
    def of(
        cls, recorder: Recorder, run: SeenRun, channel: Channel, measured: Floats
    ) -> Self | None:
        """Record axes and measured loop, shape (n,); None where there is no point of it."""
        x, finite = run.x_in_mm, np.isfinite(run.x_in_mm + measured)
        if not finite.any():
            return None
        axes = axis_of(x[finite], WIDTH), axis_of(measured[finite], -HEIGHT)
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
        shades = [dark(role_of_phase(p)) if p in PHASES else colour for p, _ in found]
        strips = [strip for _, strip in found]
        packed = np.array(shades, np.uint32)  # three numbers in a list would be one colour
        look = rr.LineStrips2D(strips, colors=packed, radii=-2.0 / order, draw_order=order)
        self.recorder.static(f"{self.entity}/{key}", look)
        now = f"{self.entity}/{key}/now"
        style = rr.Points2D.from_fields(
            colors=colour, radii=-6.0 / order**0.5, draw_order=order + 9.0
        )
        self.recorder.static(now, style)
        places = self._places(self.moments, y)
        finite = np.flatnonzero(np.isfinite(places).all(axis=1))
        times = self.run.times.at(self.moments[finite])
        self.recorder.columns(now, times, rr.Points2D.columns(positions=places[finite]))

    def _places(self, at: Indices, y: Floats) -> Floats:
        return np.column_stack((self.x.place(self.run.x_in_mm[at]), self.y.place(y[at])))

    def _record_axes(self, x_label: str, y_label: str) -> None:
        across, up = self.x.ticks(), self.y.ticks()
        at_x, at_y = self.x.place(across), self.y.place(up)
        lines = [[[0.0, -HEIGHT], [0.0, 0.0], [WIDTH, 0.0]]]
        lines += [[[at, 0.0], [at, TICK]] for at in at_x]
        lines += [[[-TICK, at], [0.0, at]] for at in at_y]
        look = rr.LineStrips2D(lines, colors=dark("muted"), radii=-0.6, draw_order=-1.0)
        self.recorder.static(f"{self.entity}/axes", look)
        places = [*((at, 0.02) for at in at_x), *((-0.1, at - 0.04) for at in at_y)]
        places += [(0.5 * WIDTH, 0.14), (0.35 * WIDTH, -HEIGHT - 0.06)]
        labels = [*map(as_printed, (*across, *up)), x_label, y_label]
        names = rr.Points2D(places, labels=labels, colors=dark("ink"), radii=0.0, show_labels=True)
        self.recorder.static(f"{self.entity}/names", names)


def entities_of(run: SeenRun) -> dict[str, list[str]]:
    """Return the entities of all series, by the column that they are shown with."""
    found: dict[str, list[str]] = {}
    for channel in run.channels:
        keys = (channel.key, *(source.key for source in channel.sources))
        found.setdefault(channel.quantity, []).extend(
            run.entity(channel.quantity, key) for key in keys
        )
    if run.tracked is not None:
        found[FORCE].append(run.entity(FORCE, "true"))
    return found


def residuals_of(run: SeenRun) -> dict[str, list[str]]:
    """Return the entities of the residuals by column."""
    found = {
        channel.column: [
            run.entity(channel.column, RESIDUAL, source.key)
            for source in channel.sources
            if not source.cleaned
        ]
        for channel in run.channels
    }
    return {column: entities for column, entities in found.items() if entities}


def record_channels(recorder: Recorder, run: SeenRun) -> None:
    """Record the channels of one run, its residuals and its loops; of series all samples."""
    controller = None if run.tracked is None else run.tracked.controller
    for channel in run.channels:
        measured, name, colour = run.measured(channel.column), channel.key, _ROLES[channel.key]
        if controller and channel.column == SPEED:  # which a controller asks for
            name, colour = controller, role_of_controller(controller)
        entity, width = run.entity(channel.quantity, channel.key), _WIDTHS[channel.key]
        recorder.series(entity, run.times, measured, name, dark(colour), width=width)
        loop = LoopPlane.of(recorder, run, channel, measured) if channel in run.loops else None
        for number, source in enumerate(channel.sources):
            values = run.predicted(channel.column, source)
            series = {run.entity(channel.column, source.key): values}
            if not source.cleaned:
                residual = run.entity(channel.column, RESIDUAL, source.key)
                series[residual] = measured - values
            for entity, samples in series.items():
                recorder.series(entity, run.times, samples, source.label, dark(source.role))
            if loop is not None:
                loop.record(source.key, values, dark(source.role), order=2.0 + number)
        recorder.settle()


def record_tracking(recorder: Recorder, run: SeenRun) -> None:
    """Record what a tracked run holds beside its sensors; nothing for any other run."""
    if run.tracked is None:
        return
    name = run.tracked.controller
    wanted, true = run.file.read(tracked.WANTED), run.file.read(tracked.TRUE)
    kept = {run.entity(FORCE, "true"): true, run.entity(ERROR): wanted - true}
    kept |= {run.entity(state): run.file.read(state) for state in STATES if state in run.file.names}
    for entity, values in kept.items():
        recorder.series(entity, run.times, values, name, dark(role_of_controller(name)))


def faults_of(run: SeenRun) -> list[Finding]:
    """Return what a check found in a run."""
    check = run.inputs.get(CheckFile)
    return [] if check is None else [f for f in check.findings if f.run == run.id]


def record_faults(recorder: Recorder, run: SeenRun) -> None:
    """Record the faults of a run; one of the whole run stands at its start."""
    if faults := faults_of(run):
        start_s = float(run.time_s[0])
        at_s = [start_s if f.first_s is None else f.first_s for f in faults]
        log = rr.TextLog.columns(
            text=[
                f"{at:.3f} s: {f.code}: {f.sentence}" for at, f in zip(at_s, faults, strict=True)
            ],
            level=[_LEVELS.get(fault.severity, "INFO") for fault in faults],
        )
        recorder.columns(run.entity("faults"), run.at(np.array(at_s)), log)


def record_phases(recorder: Recorder, run: SeenRun) -> None:
    """Record when each phase begins, and where the last one ends; nothing without segments."""
    if not run.segments:
        return
    look = rr.StateConfiguration(
        values=list(PHASES),
        labels=[label_of(phase) for phase in PHASES],
        colors=[dark(role_of_phase(phase)) for phase in PHASES],
    )
    starts: list[float] = []
    keys: list[str] = []
    for segment, after in zip(run.segments, (*run.segments[1:], None), strict=True):
        starts.append(segment.start_s)
        keys.append(segment.phase if segment.phase in PHASES else "unknown")
        if after is None or after.start_s > segment.end_s:  # a stretch in none has no name
            starts.append(segment.end_s)
            keys.append("")
    recorder.static(run.entity("phase"), look)
    states = rr.StateChange.columns(state=keys)
    recorder.columns(run.entity("phase"), run.at(np.array(starts)), states)


def axis_of(values: Floats, end: float) -> Axis:
    """Return the axis of values, NaN for gaps; there must be one."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = MARGIN * ((high - low) or abs(high) or 1.0)
    return Axis(low - room, high + room, end)


def view_of(run: SeenRun, channel: Channel, titled: str = "") -> rrb.View:
    """Return the view of a loop; `titled` names it where it does not stand with its run."""
    name = f"{in_words(channel.column)} over displacement"
    return rrb.Spatial2DView(
        name=f"{titled}: {name}" if titled else name,
        contents=f"+ {run.entity(channel.column, 'loop')}/**",
        visual_bounds=_SEEN,
    )


def _strips(places: Floats, labels: npt.NDArray[np.object_]) -> Iterator[tuple[str, Floats]]:
    """Yield each stretch of one label, up to the next one's first point, but over no gap."""
    finite = np.atleast_1d(np.isfinite(places).all(axis=1))
    labels = np.where(finite, labels, "")
    edges = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1), len(labels)]
    for first, end in pairwise(edges):
        if labels[first]:
            yield labels[first], places[first : end + int(end < len(labels) and finite[end])]
