"""Curves over time, one colour for each controller: in one plot, or one below the other."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.figures import bound, legend, line
from tsas_cli.support.arrays import Floats


@dataclass(frozen=True)
class TimeCurve:
    """What it is called, the controller that it is of, and its values, shape (n,)."""

    label: str
    controller: str
    values: Floats


def panels_in(panels: int) -> float:
    """Return the height in inches that so many panels need."""
    return 0.6 + (1.15 * panels if panels > 1 else 2.4)


def draw_together(
    figure: Any,
    *,
    time_s: Floats,
    wanted: Floats,
    curves: Sequence[TimeCurve],
    label: str,
    change_s: float | None = None,
) -> None:
    """Draw what is wanted, wide and grey, and all curves over it; `label` names the axis."""
    axes = figure.add_subplot()
    line(axes, time_s, wanted, color=STAND_IN["measured"], linewidth=3.2, label="wanted")
    for curve in curves:
        colour = of_controller(curve.controller)
        line(axes, time_s, curve.values, color=colour, linewidth=1.1, label=curve.label)
    mark_change(axes, change_s)
    axes.set(xlabel="time [s]", ylabel=label)
    legend(figure)


def draw_panels(
    figure: Any,
    *,
    time_s: Floats,
    curves: Sequence[TimeCurve],
    label: str,
    change_s: float | None = None,
    band: float | None = None,
    same_scale: bool = False,
) -> None:
    """Draw one panel for each curve, its name above it; `band` is drawn to both sides of zero."""
    rows = figure.subplots(len(curves), 1, sharex=True, sharey=same_scale, squeeze=False)[:, 0]
    for axes, curve in zip(rows, curves, strict=True):
        axes.axhline(0.0, color=STAND_IN["muted"], linewidth=0.9)
        line(axes, time_s, curve.values, color=of_controller(curve.controller), linewidth=0.9)
        limits = axes.get_ylim()
        for side in (-1.0, 1.0) if band is not None else ():
            bound(axes, side * (band or 0.0))
        axes.set_ylim(limits)
        mark_change(axes, change_s)
        axes.set_ylabel(label)
        axes.set_title(curve.label, loc="left", fontsize=9.0, pad=3.0)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()


def mark_change(axes: Any, change_s: float | None) -> None:
    """Draw where the plant changes."""
    if change_s is not None:
        axes.axvline(change_s, color=STAND_IN["ink"], linewidth=1.0, linestyle=(0, (1, 2)))
