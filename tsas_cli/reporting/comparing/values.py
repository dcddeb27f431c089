"""The values that both models have, with their intervals, as a picture."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.stage import differs
from tsas_cli.records.comparison import ParameterPair
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures import legend
from tsas_cli.reporting.numbers import plain

_MOST = 8  # strips of a picture


@dataclass(frozen=True)
class IntervalMark:
    """A value and its 95 % interval in the parameter's unit, None where it has none."""

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Strip:
    """One parameter: its name, what both say of it, and whether that differs."""

    label: str
    a: IntervalMark
    b: IntervalMark
    differs: bool


def pictures(it: Comparison) -> Iterator[Picture]:
    """Yield the picture of fitted values, differing ones first, those of single runs last."""
    shown = [p for p in it.pairs if p.a and p.b and "fitted" in (p.a.origin, p.b.origin)]
    shown.sort(key=lambda pair: (pair not in it.differing, pair.run != "all"))
    strips = [_strip(pair) for pair in shown[:_MOST]]
    if not strips:
        return
    said = "; ".join(
        f"{s.label}: A {plain(s.a.value)}, B {plain(s.b.value)}"
        f"{', which differs' if s.differs else ''}"
        for s in strips
    )
    star = " A star marks a difference beyond both uncertainties." if it.tested else ""
    yield picture(
        partial(draw_values, strips=strips),
        key="values",
        alt=f"Values of A and B with 95 % intervals, each on its own axis. {said}.",
        caption=f"Values of A and B with their 95 % intervals, each on its own axis.{star}",
        height_in=0.5 + 0.72 * len(strips),
    )


def _strip(pair: ParameterPair) -> Strip:
    a, b = (
        IntervalMark(e.value, e.interval_low, e.interval_high)
        for e in (pair.a, pair.b)
        if e is not None and e.value is not None
    )
    run = "" if pair.run == "all" else f"\nrun {pair.run}"
    return Strip(f"{pair.name.rpartition('.')[2]}{run}", a, b, differs(pair) == "yes")


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
    legend(figure, rows[0])
