"""What two models leave of each channel over time, on the same axes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.figures import line, noise_bounds

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Residuals:
    """One channel: its name at the axis, what A and B leave of it, shape (n,), and its noise."""

    label: str
    a: Floats
    b: Floats
    noise: float | None


def height_in(panels: int) -> float:
    """Return the height in inches that so many panels need."""
    return 0.8 + 1.3 * panels


def draw_two_residuals(figure: Any, *, time_s: Floats, panels: Sequence[Residuals]) -> None:
    """Draw channel below channel; the larger residual lies below the smaller one."""
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, panel in zip(rows, panels, strict=True):
        sides = (("A", panel.a, "before"), ("B", panel.b, "after"))
        for name, values, role in sorted(sides, key=lambda side: -float(np.nanstd(side[1]))):
            line(axes, time_s, values, color=STAND_IN[role], linewidth=0.7, label=name)
        noise_bounds(axes, panel.noise)
        axes.set_ylabel(panel.label)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    handles = dict(zip(*rows[0].get_legend_handles_labels()[::-1], strict=True))
    figure.legend(
        [handles[name] for name in sorted(handles)],
        sorted(handles),
        loc="outside upper left",
        ncols=3,
        handlelength=1.6,
        columnspacing=1.2,
    )
