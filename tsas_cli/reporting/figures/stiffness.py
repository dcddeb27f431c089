"""One phase's stiffness of every run: fitted with its interval, expected, and by theory."""

from collections.abc import Sequence
from typing import Any

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.phases import BY_KEY
from tsas_cli.reporting.stage_files import Stiffness

_NAME_LENGTH = 14


def height_in(runs: int) -> float:
    """Return the height in inches that a plot of so many runs needs."""
    return 1.5 + 0.28 * runs


def draw_stiffness(figure: Any, rows: Sequence[Stiffness]) -> None:
    """Draw the rows of one phase, one line per run, the first on top."""
    axes = figure.add_subplot()
    phase = BY_KEY[rows[0].phase]
    places = range(len(rows))
    _interval(axes, rows, colour=STAND_IN[phase.colour])
    for marker, label, values in (
        ("D", "linear fit of the model", [row.expected_N_per_mm for row in rows]),
        ("|", "theory", [row.theory_N_per_mm for row in rows]),
    ):
        there = [(value, place) for value, place in zip(values, places, strict=True) if value]
        if there:
            axes.plot(
                *zip(*there, strict=True),
                linestyle="none",
                marker=marker,
                markersize=11 if marker == "|" else 6,
                markeredgewidth=1.6,
                markerfacecolor="none",
                color=STAND_IN["ink"],
                label=label,
            )
    axes.set_yticks(list(places), [_short(row.run) for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.margins(x=0.12)
    axes.set_xlabel(f"km in {phase.label} [N/mm]")
    figure.legend(loc="outside upper left", ncols=2, handlelength=1.4, columnspacing=1.2)


def _interval(axes: Any, rows: Sequence[Stiffness], *, colour: str) -> None:
    for place, km in enumerate(row.km for row in rows):
        if km.value is None:
            continue
        style = {"color": colour, "label": "linear fit, 95 %" if place == 0 else None}
        if km.interval_low is None or km.interval_high is None:
            axes.plot([km.value], [place], marker="o", **style)
            continue
        sides = [[km.value - km.interval_low], [km.interval_high - km.value]]
        axes.errorbar([km.value], [place], xerr=sides, fmt="o", capsize=4, **style)


def _short(name: str) -> str:
    if len(name) <= _NAME_LENGTH:
        return name
    half = _NAME_LENGTH // 2
    return f"{name[:half]}…{name[-half + 1 :]}"
