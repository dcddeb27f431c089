"""Simulation over measurement along the time, and the residual under it."""

from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.decimation import kept_samples

Floats = npt.NDArray[np.float64]


def draw_comparison(
    figure: Any,
    *,
    time_s: Floats,
    measured: Floats,
    simulated: Floats,
    noise: float | None,
    labels: tuple[str, str],
) -> None:
    """Draw one channel of one run.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    time_s, measured, simulated
        Time [s], and the channel in its unit, shape (n,), NaN where there is none.
    noise
        Standard deviation of the channel's noise in its unit, None where it is not known.
    labels
        What stands at the axis of the channel, and at that of the residual.
    """
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    _line(upper, time_s, measured, color=STAND_IN["measured"], linewidth=2.6, label="measured")
    _line(upper, time_s, simulated, color=STAND_IN["simulated"], linewidth=1.1, label="simulated")
    upper.set_ylabel(labels[0])
    _line(lower, time_s, measured - simulated, color=STAND_IN["muted"], linewidth=0.7)
    if noise is not None:
        edge = {"color": STAND_IN["ink"], "linewidth": 1.0, "linestyle": (0, (4, 3)), "zorder": 3}
        lower.axhline(2 * noise, **edge, label="± 2 × noise")
        lower.axhline(-2 * noise, **edge)
    lower.set(xlabel="time [s]", ylabel=labels[1])
    figure.align_ylabels()
    figure.legend(loc="outside upper left", ncols=3, handlelength=1.6, columnspacing=1.2)


def _line(axes: Any, time_s: Floats, values: Floats, **style: Any) -> None:
    kept = kept_samples(values)
    axes.plot(time_s[kept], values[kept], **style)
