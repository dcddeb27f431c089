"""The dead band from near: tension at the drive over its travel since it turned."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.physics.passages import Passage
from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.plane import ACROSS, DOWN, Frame, frame_of
from tsas_cli.reporting.stream.recorder import Clock, Recorder, Times
from tsas_cli.reporting.stream.recorder.layout import Plane
from tsas_cli.reporting.stream.recorder.moving import points_2d
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.tendon.key import record_key
from tsas_cli.reporting.tendon.followed import Followed, Which

Floats = npt.NDArray[np.float64]

BEYOND = 1.4  # of the widest dead band: how much of a stroke is shown
POINTS = 80  # of a curve
X_LABEL, Y_LABEL = "travel of the drive since it turned [mm]", "tension at the drive [N]"


def view_of_band(entity: Entity) -> Plane:
    """Return the view that shows it."""
    return Plane("The dead band from near", [entity], ACROSS, DOWN)


def record_band(
    recorder: Recorder,
    entity: Entity,
    clock: Clock,
    tendons: Mapping[Which, Followed],
    f_in_N: Floats | None,
) -> None:
    """Record the strokes of one run, one after the other; return the view that shows them.

    Parameters
    ----------
    recorder, entity, clock
        Where to, under which name, and when the run began.
    tendons
        The models' answers.
    f_in_N
        Measured, shape (n,), NaN for gaps; None where it was not.
    """
    widest = max((_width(one) for one in tendons.values()), default=0.0)
    if widest == 0.0:
        return
    curves = {
        which: _strokes(one.passages, one.response.x_in_mm, one.response.f_in_N, widest)
        for which, one in tendons.items()
    }
    every = np.concatenate([curve[..., 1].ravel() for curve in curves.values()])
    frame = frame_of(np.array([0.0, widest]), every)
    recorder.curves_2d([*entity, "axes"], frame.lines(), colour("muted"), radius=-0.6, order=-1.0)
    places, texts = frame.texts(X_LABEL, Y_LABEL)
    recorder.labels_2d([*entity, "names"], places, texts, colour("muted"))
    record_key(recorder, entity, tendons, measured=f_in_N is not None)
    if f_in_N is not None:
        one = next(iter(tendons.values()))
        strokes = _strokes(one.passages, one.response.x_in_mm, f_in_N, widest)
        at, placed = _starts(clock, one), _placed(frame, strokes)
        wide, under = -3.5, 0.0
        seen = colour("measured")
        recorder.segments_2d([*entity, "measured"], at, placed, seen, radius=wide, order=under)
    for which, one in tendons.items():
        mine, shade = [*entity, which.key], colour(which.role)
        placed = _placed(frame, curves[which])
        recorder.segments_2d([*mine, "stroke"], _starts(clock, one), placed, shade, radius=-1.2)
        samples = one.frames.samples
        x, f_in = one.response.x_in_mm[samples], one.response.f_in_N[samples]
        travel = np.abs(x - x[one.turned()])
        now = frame.place(travel, f_in)
        there = [now[k : k + seen] for k, seen in enumerate(travel <= widest)]
        points_2d(recorder, [*mine, "now"], clock.times(one.time_s), there, shade)


def _starts(clock: Clock, one: Followed) -> Times:
    return clock.times(one.sample_time_s[[passage.start for passage in one.passages]])


def _width(one: Followed) -> float:
    """Return how much of a stroke is to be shown [mm]."""
    x = one.response.x_in_mm
    through = [
        abs(x[run.arrived] - x[run.start]) for run in one.passages if run.arrived is not None
    ]
    return BEYOND * float(max(through, default=np.ptp(x) if x.size else 0.0))


def _strokes(runs: list[Passage], x: Floats, f_in: Floats, widest: float) -> Floats:
    """Return tension over travel for each stroke, shape (k, POINTS, 2) [mm, N]."""
    ends = [*(run.start for run in runs[1:]), x.size - 1]
    strokes = np.empty((len(runs), POINTS, 2))
    for stroke, run, end in zip(strokes, runs, ends, strict=True):
        travel = np.abs(x[run.start : end + 1] - x[run.start])
        shown = np.flatnonzero((travel <= widest) & np.isfinite(f_in[run.start : end + 1]))
        kept = shown[np.linspace(0, shown.size - 1, POINTS).astype(int)]
        stroke[:, 0], stroke[:, 1] = travel[kept], f_in[run.start + kept]
    return strokes


def _placed(frame: Frame, strokes: Floats) -> Floats:
    return np.stack([frame.place(stroke[:, 0], stroke[:, 1]) for stroke in strokes])
