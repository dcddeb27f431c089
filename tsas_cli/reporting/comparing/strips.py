"""Values of two models with their intervals, each parameter on an axis of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.reporting.colours import STAND_IN


@dataclass(frozen=True)
class Value:
    """A value and its 95 % interval in the parameter's unit, None where it has none."""

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Strip:
    """One parameter: its name, what both say of it, and whether that differs."""

    label: str
    a: Value
    b: Value
    differs: bool


def height_in(strips: int) -> float:
    """Return the height in inches that so many strips need."""
    return 0.5 + 0.72 * strips


def draw_values(figure: Any, strips: Sequence[Strip]) -> None:
    """Draw the strips below each other, A above B in each; a star marks those that differ."""
    rows = figure.subplots(len(strips), 1, squeeze=False)[:, 0]
    for axes, strip in zip(rows, strips, strict=True):
        for name, value, role, y in (("A", strip.a, "before", 1.0), ("B", strip.b, "after", 0.0)):
            low, high = (value.value if end is None else end for end in (value.low, value.high))
            axes.errorbar(
                value.value,
                y,
                xerr=[[value.value - low], [high - value.value]],
                marker="o",
                markersize=5,
                capsize=3,
                elinewidth=1.6,
                linestyle="none",
                color=STAND_IN[role],
                label=name,
            )
        axes.set(ylim=(-0.6, 1.6), yticks=[])
        axes.margins(x=0.08)
        axes.locator_params(axis="x", nbins=4)
        axes.ticklabel_format(axis="x", useOffset=False)
        star = " *" if strip.differs else ""
        axes.set_ylabel(strip.label + star, rotation=0, ha="right", va="center")
        axes.spines["left"].set_visible(False)
    handles, labels = rows[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=2, handlelength=1.6)
