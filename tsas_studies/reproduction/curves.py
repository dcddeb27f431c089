"""Curves over one pair of axes, as a group of the reproduction gives them."""

from typing import Any

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.drawing import kept_samples
from tsas_studies.reproduction.group import Figure

COLUMNS = 2  # of the legend, which a phone shows whole


def draw_curves(drawing: Any, figure: Figure) -> None:
    """Draw the lines of a figure, the later over the earlier ones."""
    axes = drawing.add_subplot()
    for line in figure.lines:
        kept = kept_samples(line.x, line.y)
        axes.plot(
            line.x[kept],
            line.y[kept],
            color=STAND_IN[line.role],
            linestyle="none" if line.mark else (0, (5, 3)) if line.dashed else "-",
            marker=line.mark or None,
            label=line.label,
        )
    axes.set(xlabel=figure.axes[0], ylabel=figure.axes[1])
    drawing.legend(loc="outside upper left", ncols=COLUMNS, handlelength=1.8, columnspacing=1.2)
