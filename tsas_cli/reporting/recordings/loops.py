"""Both tensions over the displacement of the drive, with the phases of the cycle."""

from collections.abc import Iterator
from functools import partial
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.recording import Recording
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.reporting.channels import at_axis, in_words
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Group, Picture, Section
from tsas_cli.reporting.decimation import POINTS, kept_samples, shared_points
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures import legend
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import spanned
from tsas_cli.reporting.phases import PHASES, Phase, phase_of_samples
from tsas_cli.support.arrays import Floats, Mask

_TENSIONS = ("f_in_N", "f_out_N")
_X = "x_in_mm"
_MOST_RUNS = 10
_POINTS = 20_000  # of all loops
Keys = npt.NDArray[np.object_]


def section(inputs: Inputs) -> Section | None:
    """Return the section of the loops, one group per run, None where there is no dataset."""
    if inputs.dataset is None:
        return None
    intro = "Each cycle runs through four phases, numbered in the order in which they follow."
    calibration = inputs.get(CalibrationFile)
    if calibration is None:
        intro = "Without a folder written by `tsas calibrate`, the phases are unknown."
    segments = calibration.segments if calibration else {}
    runs = 0 if inputs.dataset is None else len(inputs.dataset.runs)
    points = shared_points(len(_TENSIONS) * min(runs, _MOST_RUNS), _POINTS)
    groups = tuple(
        Group(f"Run {one.run.id}", pictures)
        for number, one in enumerate(islice(inputs.recordings, _MOST_RUNS))
        if (pictures := tuple(_pictures(one, segments.get(one.run.id, ()), number, points)))
    )
    if not groups:
        intro = "No run holds x_in_mm and a tension: there is no loop to show."
    more = (f"The first {_MOST_RUNS} of {runs} runs are shown.",) if runs > _MOST_RUNS else ()
    return Section("loops", "Loops and phases", (intro, *more), groups=groups, given=bool(groups))


def _pictures(
    recording: Recording, segments: tuple[PhaseSegment, ...], number: int, points: int
) -> Iterator[Picture]:
    phase = phase_of_samples(recording.time_s, segments)
    x = recording.get(_X)
    for column in _TENSIONS:
        y = recording.get(column)
        if x is None or y is None or not np.isfinite(x + y).any():
            continue
        yield picture(
            partial(
                draw_loop,
                x=x,
                y=y,
                phase=phase,
                labels=(at_axis(_X), at_axis(column)),
                points=points,
            ),
            key=f"loop-{number}-{column}",
            alt=_alt(recording.run.id, x, y, phase, column),
            caption=f"{in_words(column).capitalize()} over {in_words(_X)}.",
        )


def _alt(run: str, x: Floats, y: Floats, phase: npt.NDArray[np.object_], column: str) -> str:
    whole = f"{at_axis(column)} {spanned(y)} over {at_axis(_X)} {spanned(x)}"
    shown = [one for one in PHASES if one.number and np.isfinite(y[phase == one.key]).any()]
    each = "; ".join(f"{one.label} {spanned(y[phase == one.key])}" for one in shown)
    return f"Loop of run {run}: {whole}. By phase: {each or 'unknown'}."


def draw_loop(
    figure: Any,
    *,
    x: Floats,
    y: Floats,
    phase: Keys,
    labels: tuple[str, str],
    points: int = POINTS,
) -> None:
    """Draw the loop of one run.

    `x` [mm] and `y` [N] have shape (n,), NaN for gaps, and so has the key of the phase; `labels`
    are the names of the two axes, with units.
    """
    axes = figure.add_subplot()
    y = np.where(np.isfinite(x), y, np.nan)
    kept = kept_samples(x, y, points=points)
    for one in PHASES:
        if (phase == one.key).any():
            _draw_phase(axes, x[kept], y[kept], phase[kept] == one.key, one)
            _number(axes, x, y, phase == one.key, one)
    axes.set(xlabel=labels[0], ylabel=labels[1])
    if (phase != "unknown").any():
        legend(figure)


def _draw_phase(axes: Any, x: Floats, y: Floats, inside: Mask, one: Phase) -> None:
    joined = inside.copy()
    joined[1:] |= inside[:-1]  # up to the first sample of the next phase: no hole between two
    label = f"{one.number} {one.label}".strip()
    axes.plot(x, np.where(joined, y, np.nan), color=STAND_IN[one.colour], label=label)


def _number(axes: Any, x: Floats, y: Floats, inside: Mask, one: Phase) -> None:
    """Put the phase's number on its longest stretch, apart from that of the opposite phase."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(int)))
    first, after = max(edges.reshape(-1, 2), key=lambda stretch: stretch[1] - stretch[0])
    there = y[first:after]
    if not one.number or not np.isfinite(there).any():
        return
    height = 0.6 if one.number in "12" else 0.4
    level = height * np.nanmax(there) + (1 - height) * np.nanmin(there)
    at = first + int(np.nanargmin(np.abs(there - level)))
    axes.text(
        x[at],
        y[at],
        one.number,
        color=STAND_IN[one.colour],
        ha="center",
        va="center",
        fontsize=8.5,
        fontweight="bold",
        clip_on=True,
        bbox={
            "boxstyle": "circle,pad=0.25",
            "facecolor": STAND_IN["paper"],
            "edgecolor": STAND_IN[one.colour],
        },
    )
