"""A tension over the displacement of the drive, coloured and numbered by phase."""

from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.decimation import kept_samples
from tsas_cli.reporting.phases import PHASES, Phase

Floats = npt.NDArray[np.float64]
Keys = npt.NDArray[np.object_]


def draw_loop(figure: Any, *, x: Floats, y: Floats, phase: Keys, labels: tuple[str, str]) -> None:
    """Draw the loop of one run.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    x, y
        Displacement [mm] and tension [N], shape (n,), NaN for gaps.
    phase
        The key of the phase at each sample, shape (n,).
    labels
        The names of the two axes, with units.
    """
    axes = figure.add_subplot()
    y = np.where(np.isfinite(x), y, np.nan)
    kept = kept_samples(x, y)
    for one in PHASES:
        if (phase == one.key).any():
            _draw_phase(axes, x[kept], y[kept], phase[kept] == one.key, one)
            _number(axes, x, y, phase == one.key, one)
    axes.set(xlabel=labels[0], ylabel=labels[1])
    if (phase != "unknown").any():
        figure.legend(loc="outside upper left", ncols=2, handlelength=1.6, columnspacing=1.2)


def _draw_phase(axes: Any, x: Floats, y: Floats, inside: npt.NDArray[np.bool_], one: Phase) -> None:
    joined = inside.copy()
    joined[1:] |= inside[:-1]  # up to the first sample of the next phase: no hole between two
    label = f"{one.number} {one.label}".strip()
    axes.plot(x, np.where(joined, y, np.nan), color=STAND_IN[one.colour], label=label)


def _number(axes: Any, x: Floats, y: Floats, inside: npt.NDArray[np.bool_], one: Phase) -> None:
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
