"""Estimates over time between their bounds, one panel each."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import of_controller
from tsas_cli.reporting.figures import dashed, line
from tsas_cli.reporting.tracking.over_time import mark_change

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """One parameter: symbol, unit, values over time, shape (n,), and bounds."""

    symbol: str
    unit: str
    values: Floats
    lowest: float
    highest: float


def draw_estimates(
    figure: Any,
    *,
    time_s: Floats,
    estimates: Sequence[Estimate],
    role: str,
    change_s: float | None = None,
) -> None:
    """Draw one panel for each estimate, its axis in powers of ten where all is positive."""
    rows = figure.subplots(len(estimates), 1, sharex=True, squeeze=False)[:, 0]
    for axes, it in zip(rows, estimates, strict=True):
        line(axes, time_s, it.values, color=of_controller(role), linewidth=1.3)
        for bound in (it.lowest, it.highest):
            axes.axhline(bound, **dashed())
        if min(it.lowest, float(it.values.min())) > 0.0:
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter("{x:g}")
            axes.yaxis.set_minor_formatter("")
        mark_change(axes, change_s)
        axes.set_title(f"{it.symbol} [{it.unit}]", loc="left", fontsize=9.0, pad=3.0)
    rows[-1].set_xlabel("time [s]")
