"""The dead band from near: tension at the drive over its travel since it turned."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.physics.passages import ends_of
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.stream.plane import Frame, frame_of, record_frame, record_key
from tsas_cli.reporting.stream.recorder import Entity, Recorder, Times
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.tendon.followed import TendonStates

Floats = npt.NDArray[np.float64]

BEYOND = 1.4  # of the widest dead band: how much of a stroke is shown
POINTS, LEAST, MOST = 80, 12, 60_000  # of a stroke, usually and at least, and of all of a run
X_LABEL, Y_LABEL = "travel of the drive since it turned [mm]", "tension at the drive [N]"


def record_band(
    recorder: Recorder,
    entity: Entity,
    tendons: Mapping[Which, TendonStates],
    f_in_N: Floats | None,
) -> None:
    """Record the strokes of one run, one after the other.

    `f_in_N` is measured, shape (n,), NaN for gaps; None where it was not.
    """
    widest = max((_width(one) for one in tendons.values()), default=0.0)
    if widest == 0.0:
        return
    curves = {which: _strokes(one, one.response.f_in_N, widest) for which, one in tendons.items()}
    every = np.concatenate([strokes[..., 1].ravel() for _, strokes in curves.values()])
    frame = frame_of(np.array([0.0, widest]), every)
    record_frame(recorder, entity, frame, (X_LABEL, Y_LABEL), "muted")
    record_key(recorder, entity, tendons, measured=f_in_N is not None)
    if f_in_N is not None:
        first = next(iter(tendons.values()))
        at, strokes = _strokes(first, f_in_N, widest)
        under, placed = [*entity, "measured"], _placed(frame, strokes)
        recorder.segments_2d(under, at, placed, dark("measured"), radius=-3.5, order=0.0)
    for which, one in tendons.items():
        mine, shade = [*entity, which.key], dark(which.role)
        at, strokes = curves[which]
        placed = _placed(frame, strokes)
        recorder.segments_2d([*mine, "stroke"], at, placed, shade, radius=-1.2)
        x, f_in = one.response.x_in_mm, one.response.f_in_N[one.frames.samples]
        travel = np.abs(x[one.frames.samples] - x[one.turned()])
        now = frame.place(travel, f_in)
        recorder.points_2d([*mine, "now"], one.times, now, shade, shown=travel <= widest)


def _width(one: TendonStates) -> float:
    """Return how much of a stroke is to be shown [mm]."""
    x = one.response.x_in_mm
    through = [
        abs(x[run.arrived] - x[run.start]) for run in one.passages if run.arrived is not None
    ]
    return BEYOND * float(max(through, default=np.ptp(x) if x.size else 0.0))


def _strokes(one: TendonStates, f_in: Floats, widest: float) -> tuple[Times, Floats]:
    """Return when strokes began, shape (k,), and their tension over travel, shape (k, p, 2).

    Those of which nothing is known, since the tension is NaN, are left out.
    """
    x, runs = one.response.x_in_mm, one.passages
    ends = ends_of(runs, x.size - 1)
    points = min(POINTS, max(LEAST, MOST // max(len(runs), 1)))
    at, strokes = [], []
    for run, end in zip(runs, ends, strict=True):
        travel = np.abs(x[run.start : end + 1] - x[run.start])
        shown = np.flatnonzero((travel <= widest) & np.isfinite(f_in[run.start : end + 1]))
        if shown.size:
            kept = shown[np.linspace(0, shown.size - 1, points).astype(int)]
            at.append(one.sample_time_s[run.start])
            strokes.append(np.column_stack((travel[kept], f_in[run.start + kept])))
    return one.at(np.array(at)), np.array(strokes).reshape(-1, points, 2)


def _placed(frame: Frame, strokes: Floats) -> Floats:
    flat = strokes.reshape(-1, 2)
    return frame.place(flat[:, 0], flat[:, 1]).reshape(strokes.shape)
