"""The dead band from near: tension at the drive over its travel since it turned."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.physics.passages import Passage
from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.plane import ACROSS, DOWN, Frame, frame_of
from tsas_cli.reporting.stream.recorder import Clock, Recorder
from tsas_cli.reporting.stream.recorder.layout import Plane
from tsas_cli.reporting.stream.recorder.moving import points_2d
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.tendon.key import record_key
from tsas_cli.reporting.tendon.followed import Followed, Which

Floats = npt.NDArray[np.float64]

BEYOND = 1.4  # of the widest dead band: how much of a stroke is shown
POINTS = 80  # of a curve


def record_band(
    recorder: Recorder,
    entity: Entity,
    clock: Clock,
    tendons: Mapping[Which, Followed],
    f_in_N: Floats | None,
) -> Plane | None:
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
        return None
    curves = {
        which: _strokes(one.passages, one.response.x_in_mm, one.response.f_in_N, widest)
        for which, one in tendons.items()
    }
    frame = frame_of(np.array([0.0, widest]), np.concatenate([c[..., 1].ravel() for c in curves.values()]))
    recorder.curves_2d([*entity, "axes"], frame.lines(), colour("muted"), radius=-0.6, order=-1.0)
    places, texts = frame.texts("travel of the drive since it turned [mm]", "tension at the drive [N]")
    recorder.labels_2d([*entity, "names"], places, texts, colour("muted"))
    record_key(recorder, entity, tendons, measured=f_in_N is not None)
    first = next(iter(tendons.values()))
    starts = clock.times(first.sample_time_s[[run.start for run in first.passages]])
    if f_in_N is not None:
        measured = _strokes(first.passages, first.response.x_in_mm, f_in_N, widest)
        recorder.segments_2d([*entity, "measured"], starts, _placed(frame, measured), colour("measured"), radius=-3.5, order=0.0)
    for which, one in tendons.items():
        starts = clock.times(one.sample_time_s[[run.start for run in one.passages]])
        recorder.segments_2d([*entity, which.key], starts, _placed(frame, curves[which]), colour(which.role), radius=-1.2)
        travel = np.abs(one.response.x_in_mm[one.frames.samples] - one.response.x_in_mm[one.frames.samples[one.turned()]])
        now = frame.place(travel, one.response.f_in_N[one.frames.samples])
        there = [p[None] if t <= widest else np.empty((0, 2)) for p, t in zip(now, travel, strict=True)]
        points_2d(recorder, [*entity, which.key, "now"], clock.times(one.time_s), there, colour(which.role))
    return Plane("The dead band from near", [entity], ACROSS, DOWN)


def _width(one: Followed) -> float:
    """Return how much of a stroke is to be shown [mm]."""
    x = one.response.x_in_mm
    through = [abs(x[run.arrived] - x[run.start]) for run in one.passages if run.arrived is not None]
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
