"""One phase's stiffness of every run: fitted with its interval, of the model, and by theory."""

from collections.abc import Sequence
from typing import Any

from tsas_cli.records.calibration import Stiffness
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.drawing import shortened
from tsas_cli.reporting.phases import BY_KEY

_NAME_LENGTH = 14


def height_in(runs: int) -> float:
    """Return the height in inches that a plot of so many runs needs."""
    return 1.5 + 0.28 * runs


def draw_stiffness(figure: Any, rows: Sequence[Stiffness]) -> None:
    """Draw the rows of one phase, one line per run, the first on top."""
    axes = figure.add_subplot()
    phase = BY_KEY[rows[0].phase]
    _draw_measured(axes, rows, colour=STAND_IN[phase.colour])
    model = [row.expected_N_per_mm for row in rows]
    theory = [row.theory_N_per_mm for row in rows]
    _draw_marks(axes, model, marker="D", markersize=6, label="calibrated model")
    _draw_marks(axes, theory, marker="|", markersize=11, label="theory")
    axes.set_yticks(range(len(rows)), [shortened(row.run, _NAME_LENGTH) for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.margins(x=0.12)
    axes.set_xlabel(f"km in {phase.label} [N/mm]")
    figure.legend(loc="outside upper left", ncols=3, handlelength=1.4, columnspacing=1.2)


def _draw_measured(axes: Any, rows: Sequence[Stiffness], *, colour: str) -> None:
    """Draw the fitted values, and their intervals where they have one."""
    values = [row.km.value for row in rows]
    _draw_marks(axes, values, marker="o", markersize=6, color=colour, label="measured, 95 %")
    for place, km in enumerate(row.km for row in rows):
        if km.interval_low is not None and km.interval_high is not None:
            ends = [km.interval_low, km.interval_high]
            axes.plot(ends, [place, place], marker="|", markersize=7, color=colour)


def _draw_marks(axes: Any, values: Sequence[float | None], **style: Any) -> None:
    """Draw one mark per run, none where there is no value."""
    there = [(value, place) for place, value in enumerate(values) if value is not None]
    look = {"color": STAND_IN["ink"], "markerfacecolor": "none", "markeredgewidth": 1.5} | style
    if there:
        axes.plot(*zip(*there, strict=True), linestyle="none", **look)
