"""Both tensions over the displacement of the drive, with the phases of the cycle."""

from functools import partial

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.dataset import Recording
from tsas_cli.reporting.content import Group, Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.loops import draw_loop
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.phases import PHASES, phase_of_samples
from tsas_cli.reporting.stage_files import Calibration, Segment

_TENSIONS = {"f_in_N": "tension at the drive [N]", "f_out_N": "tension at the load [N]"}
_X = "x_in_mm"
Floats = npt.NDArray[np.float64]


def section(inputs: Inputs) -> Section:
    """Return the section of the loops, one group per run."""
    intro = ["Each cycle runs through four phases, numbered in the order in which they follow."]
    calibration = inputs.get(Calibration)
    if calibration is None:
        intro = ["Without a folder written by `tsas calibrate`, the phases are not told apart."]
    segments = calibration.segments if calibration else {}
    groups = []
    for number, recording in enumerate(inputs.dataset):
        pictures = _pictures(recording, segments.get(recording.run.id, ()), number)
        if pictures:
            groups.append(Group(f"Run {recording.run.id}", pictures))
    if not groups:
        intro = ["No run holds x_in_mm and a tension: there is no loop to show."]
    return Section("loops", "Loops and phases", tuple(intro), groups=tuple(groups))


def _pictures(
    recording: Recording, segments: tuple[Segment, ...], number: int
) -> tuple[Picture, ...]:
    phase = phase_of_samples(recording.time_s, segments)
    x = recording.get(_X)
    loops = []
    for column, label in _TENSIONS.items():
        y = recording.get(column)
        if x is None or y is None or not np.isfinite(x + y).any():
            continue
        loops.append(
            picture(
                partial(
                    draw_loop,
                    x=x,
                    y=y,
                    phase=phase,
                    labels=("displacement at the drive [mm]", label),
                ),
                key=f"loop-{number}-{column}",
                alt=_alt(recording.run.id, x, y, phase, label),
                caption=f"{label.split(' [')[0].capitalize()} over displacement at the drive.",
            )
        )
    return tuple(loops)


def _alt(run: str, x: Floats, y: Floats, phase: npt.NDArray[np.object_], label: str) -> str:
    shown = ", ".join(one.label for one in PHASES if (phase == one.key).any())
    return (
        f"Loop of run {run}: {label} from {plain(float(np.nanmin(y)))} to "
        f"{plain(float(np.nanmax(y)))} over the displacement at the drive from "
        f"{plain(float(np.nanmin(x)))} to {plain(float(np.nanmax(x)))} mm; phases: {shown}."
    )
