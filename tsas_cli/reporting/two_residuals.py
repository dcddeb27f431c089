"""What two models leave of channels or runs over time, on the same axes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.drawing import legend, line, noise_bounds
from tsas_cli.support.arrays import Floats


@dataclass(frozen=True)
class Residuals:
    """One panel: its name at the axis, time [s], both residuals, shape (n,) each, and the noise."""

    label: str
    time_s: Floats
    first: Floats
    second: Floats
    noise: float | None


def height_in(panels: int) -> float:
    """Return the height in inches that so many panels need."""
    return 0.8 + 1.3 * panels


def draw_two_residuals(
    figure: Any, *, panels: Sequence[Residuals], names: tuple[str, str] = ("A", "B")
) -> None:
    """Draw panel below panel; the larger residual lies below the smaller one."""
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, panel in zip(rows, panels, strict=True):
        both = panel.first, panel.second
        least = min(float(np.nanstd(values)) for values in both)
        for name, values, role in zip(names, both, ("before", "after"), strict=True):
            order = 2.2 if float(np.nanstd(values)) <= least else 2.1
            style = {"color": STAND_IN[role], "linewidth": 0.7, "label": name, "zorder": order}
            line(axes, panel.time_s, values, **style)
        noise_bounds(axes, panel.noise)
        axes.set_ylabel(panel.label)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    legend(figure, rows[0], ncols=3)
