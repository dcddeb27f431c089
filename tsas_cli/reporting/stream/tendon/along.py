"""Tension over the place along the sheath: now, and when the drive turned last."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.stream.plane import frame_of, record_frame, record_key
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.tendon.followed import TendonStates

Floats = npt.NDArray[np.float64]
FAINT = 0x60
X_LABEL, Y_LABEL = "place along the sheath [mm], drive to load", "tension [N]"


def record_along(recorder: Recorder, entity: Entity, tendons: Mapping[Which, TendonStates]) -> None:
    """Record the curves of one run."""
    every = np.concatenate([one.frames.tension_N.ravel() for one in tendons.values()])
    longest = max(one.rig.sheath_length_mm for one in tendons.values())
    frame = frame_of(np.array([0.0, longest]), every)
    record_frame(recorder, entity, frame, (X_LABEL, Y_LABEL), "muted")
    record_key(recorder, entity, tendons)
    for which, one in tendons.items():
        along = one.frames.places * one.rig.sheath_length_mm
        tension = np.nan_to_num(one.frames.tension_N)
        lines = np.stack([frame.place(along, now) for now in tension])
        turned = lines[np.searchsorted(one.frames.samples, one.turned())]
        mine, times, shade = [*entity, which.key], one.times, dark(which.role)
        before = dark(which.role, FAINT)
        recorder.segments_2d([*mine, "turned"], times, turned, before, radius=-1.0)
        recorder.segments_2d([*mine, "now"], times, lines, shade, radius=-2.0)
        at = frame.place(one.frames.front * one.rig.sheath_length_mm, one.tension_at_front())
        recorder.points_2d([*mine, "front"], times, at, shade, shown=one.front_runs_now)
