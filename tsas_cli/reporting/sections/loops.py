"""Both tensions over the displacement of the drive, with the phases of the cycle."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.recording import Recording
from tsas_cli.records.base import Segment
from tsas_cli.records.calibration import Calibration
from tsas_cli.reporting.channels import at_axis, in_words
from tsas_cli.reporting.content import Group, Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.loops import draw_loop
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import spanned
from tsas_cli.reporting.phases import PHASES, phase_of_samples

_TENSIONS = ("f_in_N", "f_out_N")
_X = "x_in_mm"
Floats = npt.NDArray[np.float64]


def section(inputs: Inputs) -> Section | None:
    """Return the section of the loops, one group per run, None where there is no dataset."""
    if inputs.dataset is None:
        return None
    intro = "Each cycle runs through four phases, numbered in the order in which they follow."
    calibration = inputs.get(Calibration)
    if calibration is None:
        intro = "Without a folder written by `tsas calibrate`, the phases are not told apart."
    segments = calibration.segments if calibration else {}
    groups = tuple(
        Group(f"Run {recording.run.id}", pictures)
        for number, recording in enumerate(inputs.recordings)
        if (pictures := tuple(_pictures(recording, segments.get(recording.run.id, ()), number)))
    )
    if not groups:
        intro = "No run holds x_in_mm and a tension: there is no loop to show."
    return Section("loops", "Loops and phases", (intro,), groups=groups, given=bool(groups))


def _pictures(
    recording: Recording, segments: tuple[Segment, ...], number: int
) -> Iterator[Picture]:
    phase = phase_of_samples(recording.time_s, segments)
    x = recording.get(_X)
    for column in _TENSIONS:
        y = recording.get(column)
        if x is None or y is None or not np.isfinite(x + y).any():
            continue
        yield picture(
            partial(draw_loop, x=x, y=y, phase=phase, labels=(at_axis(_X), at_axis(column))),
            key=f"loop-{number}-{column}",
            alt=_alt(recording.run.id, x, y, phase, column),
            caption=f"{in_words(column).capitalize()} over {in_words(_X)}.",
        )


def _alt(run: str, x: Floats, y: Floats, phase: npt.NDArray[np.object_], column: str) -> str:
    whole = f"{at_axis(column)} {spanned(y)} over {at_axis(_X)} {spanned(x)}"
    told = [one for one in PHASES if one.number and np.isfinite(y[phase == one.key]).any()]
    each = "; ".join(f"{one.label} {spanned(y[phase == one.key])}" for one in told)
    return f"Loop of run {run}: {whole}. By phase: {each or 'not told apart'}."
