"""One panel for each controller, a line for each case, and on it a mark for each model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.records.closing import Row
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.figures import legend


@dataclass(frozen=True)
class Look:
    """How a model is called, and the form of its mark, so that colour alone tells nothing."""

    label: str
    marker: str
    size: float = 6.0


MODELS = {  # by role
    "data-sheet": Look("data sheet", "s"),
    "calibrated": Look("calibrated", "D", 5.5),
    "extended": Look("extended", "o"),
    "true": Look("true", "|", 13.0),
}
_ROW_IN = 0.21
_PANEL_IN = 0.34  # its title


def height_in(rows: Sequence[int]) -> float:
    """Return the height in inches that panels with so many lines each need."""
    return 1.0 + sum(_PANEL_IN + _ROW_IN * count for count in rows)


def draw_dots(figure: Any, *, controllers: Mapping[str, Mapping[str, Row]]) -> None:
    """Draw the panels below each other, over one logarithmic axis.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    controllers
        By controller and case, the RMSE with each model.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    heights = [len(rows) + 0.2 for rows in controllers.values()]
    panels = figure.subplots(
        len(controllers), 1, sharex=True, squeeze=False, height_ratios=heights
    )[:, 0]
    for axes, (name, rows) in zip(panels, controllers.items(), strict=True):
        _draw_panel(axes, rows)
        axes.set_title(name, loc="left", fontsize=9.0, pad=3.0)
    last = panels[-1]
    last.set_xscale("log")
    last.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    last.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    last.xaxis.set_minor_formatter(NullFormatter())
    last.set_xlabel("RMSE of the force [N]")
    legend(figure, last, ncols=len(MODELS), handlelength=1.0)


def _draw_panel(axes: Any, rows: Mapping[str, Row]) -> None:
    places = range(len(rows))
    for place, row in zip(places, rows.values(), strict=True):
        means = [rmse.mean for rmse in row.by_model.values()]
        ends = [min(means), max(means)]
        axes.plot(ends, [place, place], color=STAND_IN["line"], linewidth=3.0, zorder=1)
    for role, look in MODELS.items():
        axes.plot(
            [row.by_model[role].mean for row in rows.values()],
            places,
            linestyle="none",
            marker=look.marker,
            markersize=look.size,
            markeredgewidth=1.6,
            markerfacecolor=STAND_IN[role] if role == "extended" else "none",
            color=STAND_IN[role],
            label=look.label,
            zorder=2 if role == "true" else 3,
        )
    axes.set_yticks(places, list(rows))
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
