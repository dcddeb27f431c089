"""What the adaptive sliding mode has learned: its estimates over time, between their bounds."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.records.tracking import ADAPTIVE, Adaptive
from tsas_cli.reporting.colours import of_controller
from tsas_cli.reporting.content import Picture, Section, table_of
from tsas_cli.reporting.drawing import bound, line, picture
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.tracking.runs import ESTIMATES, RunsUnderCondition, TrackedRun, mark_change
from tsas_cli.support.arrays import Floats

_WHAT = (
    "The estimates φ̂ of the drive's parameters (Yang 2025, Eq. 44), which stay between the dashed "
    "bounds. They serve the sliding surface; they need not come to the drive's true values."
)
_SYMBOLS = (("φ̂1", "rpm s³/mm"), ("φ̂2", "rpm s/mm"), ("φ̂3", "rpm s²/mm"))


@dataclass(frozen=True)
class AdaptiveEstimate:
    """One parameter: symbol, unit, values over time, shape (n,), and bounds."""

    symbol: str
    unit: str
    values: Floats
    lowest: float
    highest: float


def part(conditions: tuple[RunsUnderCondition, ...], law: Adaptive) -> Section | None:
    """Return the part, None where no controller adapts."""
    runs = [(c, run) for c in conditions for run in c.runs if run.name == ADAPTIVE]
    if not runs:
        return None
    rows = [row for condition, run in runs for row in _rows(condition.name, run, law)]
    header = (
        "parameter",
        "condition",
        "at the start",
        "at the end",
        "lower bound",
        "upper bound",
        "unit",
        "time at a bound [%]",
    )
    table = table_of("Adapted parameters", header, rows)
    return Section(
        "tracking-adaptation",
        "Adapted parameters",
        (_WHAT,),
        tables=(table,),
        pictures=tuple(_picture(condition, run, law) for condition, run in runs),
    )


def _estimates(run: TrackedRun, law: Adaptive) -> Iterator[AdaptiveEstimate]:
    names = zip(ESTIMATES, _SYMBOLS, law.lowest, law.highest, strict=True)
    for column, (symbol, unit), lowest, highest in names:
        yield AdaptiveEstimate(symbol, unit, run.columns[column], lowest, highest)


def _rows(condition: str, run: TrackedRun, law: Adaptive) -> Iterator[tuple[str, ...]]:
    for it in _estimates(run, law):
        at_bound = (it.values <= it.lowest) | (it.values >= it.highest)
        yield (
            it.symbol,
            condition,
            plain(float(it.values[0]), 3),
            plain(float(it.values[-1]), 3),
            f"{it.lowest:g}",
            f"{it.highest:g}",
            it.unit,
            f"{100.0 * float(np.mean(at_bound)):.0f}",
        )


def _picture(condition: RunsUnderCondition, run: TrackedRun, law: Adaptive) -> Picture:
    estimates = tuple(_estimates(run, law))
    said = "; ".join(
        f"{it.symbol} from {plain(float(it.values[0]), 3)} to {plain(float(it.values[-1]), 3)} "
        f"{it.unit}, bounds {it.lowest:g} and {it.highest:g}"
        for it in estimates
    )
    return picture(
        partial(
            draw_estimates,
            time_s=run.time_s,
            estimates=estimates,
            change_s=condition.change_s,
        ),
        key=f"tracking-adaptation-{condition.number}",
        alt=f"Adapted parameters over time, {condition.name}: {said}.",
        caption=f"{condition.name.capitalize()}: estimates over time, bounds dashed.",
        height_in=4.2,
    )


def draw_estimates(
    figure: Any,
    *,
    time_s: Floats,
    estimates: Sequence[AdaptiveEstimate],
    change_s: float | None,
) -> None:
    """Draw one panel for each estimate, its axis in powers of ten where all is positive."""
    rows = figure.subplots(len(estimates), 1, sharex=True, squeeze=False)[:, 0]
    for axes, it in zip(rows, estimates, strict=True):
        line(axes, time_s, it.values, color=of_controller(ADAPTIVE), linewidth=1.3)
        for value in (it.lowest, it.highest):
            bound(axes, value)
        if min(it.lowest, float(it.values.min())) > 0.0:
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter("{x:g}")
            axes.yaxis.set_minor_formatter("")
        mark_change(axes, change_s)
        axes.set_title(f"{it.symbol} [{it.unit}]", loc="left", fontsize=9.0, pad=3.0)
    rows[-1].set_xlabel("time [s]")
