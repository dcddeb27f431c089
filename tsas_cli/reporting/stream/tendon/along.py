"""Tension over the place along the sheath: now, and when the drive turned last."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.plane import ACROSS, DOWN, frame_of, record_frame
from tsas_cli.reporting.stream.recorder import Clock, Recorder
from tsas_cli.reporting.stream.recorder.moving import points_2d
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.recorder.views import View, plane
from tsas_cli.reporting.stream.tendon.followed import Followed
from tsas_cli.reporting.stream.tendon.key import record_key
from tsas_cli.reporting.which import Which

Floats = npt.NDArray[np.float64]
FAINT = 0x60
X_LABEL, Y_LABEL = "place along the sheath [mm], drive to load", "tension [N]"


def view_of_along(entity: Entity) -> View:
    """Return the view that shows it."""
    return plane("Tension along the sheath", [entity], x_range=ACROSS, y_range=DOWN)


def record_along(
    recorder: Recorder, entity: Entity, clock: Clock, tendons: Mapping[Which, Followed]
) -> None:
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
        times = clock.times(one.time_s)
        turned = lines[np.searchsorted(one.frames.samples, one.turned())]
        before = colour(which.role, FAINT)
        recorder.segments_2d([*entity, which.key, "turned"], times, turned, before, radius=-1.0)
        shade = colour(which.role)
        recorder.segments_2d([*entity, which.key, "now"], times, lines, shade, radius=-2.0)
        at = frame.place(one.frames.front * one.rig.sheath_length_mm, one.tension_at_front())
        there = [at[k : k + runs] for k, runs in enumerate(one.front_runs_now)]
        points_2d(recorder, [*entity, which.key, "front"], times, there, shade)
