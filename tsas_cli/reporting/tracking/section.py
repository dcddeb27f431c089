"""How well a wanted force is followed, by whom, and at what cost."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from tsas_cli.controllers.signals import ORDER, error_filter, filtered
from tsas_cli.records.base import ModelFile
from tsas_cli.records.tracking import ADAPTIVE, Adaptive, StatedSettings, TrackingFile
from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.content import Picture, Section, Table, table_by_column, table_of
from tsas_cli.reporting.drawing import bound, kept_cells, line, picture, stacked
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import X_IN
from tsas_cli.reporting.numbers import ABSENT, over_seeds, plain, with_spread
from tsas_cli.reporting.tracking.runs import (
    ESTIMATES,
    WANTED,
    X_INV,
    RunsUnderCondition,
    TrackedRun,
    curve_parts,
    mark_change,
    read_conditions,
)
from tsas_cli.support.arrays import Floats, Mask

_ACROSS = 2
_ADAPTED = (
    "The estimates φ̂ of the drive's parameters (Yang 2025, Eq. 44), which stay between the dashed "
    "bounds. They serve the sliding surface; they need not come to the drive's true values."
)
_PORTRAITS = (
    "The rate of the error e = x_inv − x_in of the drive over the error, both by the filter of the "
    "sliding modes ({:g} Hz). At each reversal of the wanted force the drive crosses a dead band; "
    "the loop is how the error returns to zero, the cross. Each panel has scales of its own."
)
_EXTREMES = {"lowest [N]", "highest [N]"}
_SYMBOLS = (("φ̂1", "rpm s³/mm"), ("φ̂2", "rpm s/mm"), ("φ̂3", "rpm s²/mm"))


@dataclass(frozen=True)
class AdaptiveEstimate:
    """One parameter: symbol, unit, values over time, shape (n,), and bounds."""

    symbol: str
    unit: str
    values: Floats
    lowest: float
    highest: float

    @property
    def ends(self) -> tuple[str, str]:
        """The first and the last value."""
        return plain(float(self.values[0]), 3), plain(float(self.values[-1]), 3)

    @property
    def at_bound(self) -> Mask:
        """Whether it is at a bound, shape (n,)."""
        return (self.values <= self.lowest) | (self.values >= self.highest)


def section(inputs: Inputs) -> Section | None:
    """Return the section of the closed loop, None where nothing was tracked."""
    tracking = inputs.get(TrackingFile)
    if tracking is None:
        return None
    conditions = read_conditions(inputs, tracking)
    force, error, effort = curve_parts(conditions)
    portrait = Section(
        "tracking-phase",
        "Phase portraits",
        (_PORTRAITS.format(tracking.settings.loop.filter_Hz),),
        pictures=tuple(_picture(condition, tracking.settings) for condition in conditions),
        folded=True,
    )
    adapted = adaptation_part(conditions, tracking.settings.controllers.adaptive)
    return Section(
        "tracking",
        "Tracking",
        tuple(_intro(tracking, conditions)),
        points=tracking.notes,
        tables=(_scores(tracking),),
        parts=tuple(filter(None, (force, error, effort, portrait, adapted))),
    )


def _intro(tracking: TrackingFile, conditions: tuple[RunsUnderCondition, ...]) -> Iterator[str]:
    run = conditions[0].runs[0]
    wanted = run.columns[WANTED]
    low, high = plain(float(wanted.min()), 3), plain(float(wanted.max()), 3)
    what = tracking.reference.shape or tracking.reference.file
    yield (
        f"The wanted force at the load ({what}) goes from {low} to {high} N, for "
        f"{plain(float(np.ptp(run.time_s)), 3)} s. Simulated, not measured."
    )
    sensor = tracking.settings.sensor
    same = tracking.model == tracking.plant
    tendon = ", with the dynamic chain as its tendon" if tracking.dynamics == "lugre" else ""
    rig = "the same model is the plant" if same else f"the plant is {_name(tracking.plant)}"
    yield (
        f"A controller sees x_in alone, {sensor.rate_Hz:g} times a second, with noise of "
        f"{sensor.noise_mm:g} mm and steps of {sensor.step_mm:g} mm. It knows "
        f"{_name(tracking.model)}, and of the drive {tracking.drive.file}; {rig}{tendon}."
    )
    for condition in conditions:
        changes = ", ".join(
            f"`{c.quantity}` = {c.value:g} "
            + (f"from {c.from_s:g} s on (dotted line)" if c.from_s > 0.0 else "from the start")
            for c in condition.changes
        )
        if changes:
            name = condition.name.capitalize()
            yield f"{name}: the plant has {changes}, which no controller knows."
    if tracking.gains != "default":
        yield f"The gains are {tracking.gains}."
    yield (
        "Errors are wanted less true force at the load; outside 2 % is the time in which they are "
        "beyond 2 % of the wanted force's range. Plots show the runs with the first seed."
    )
    if any(result.printed_rmse_N is not None for result in tracking.results):
        yield "Table 5 is that of Yang 2025, with the RMSE on the paper's rig."
    if tracking.notes:
        yield "Keep in mind:"


def _name(model: ModelFile) -> str:
    return "the data sheet" if model.sha256 is None else model.file


def _scores(tracking: TrackingFile) -> Table:
    """Return the scores, with their spread where there is more than one seed.

    The plots show the lowest and highest errors, without which the table is no wider than the page.
    """
    header, rows = tracking.scores(with_spread)
    for cells, result in zip(rows, tracking.results, strict=True):
        at_limit = result.scores.at_limit_percent
        cells.append(with_spread(at_limit) if at_limit.mean else ABSENT)
    header.append("at its limit [%]")
    kept = [k for k, name in enumerate(header) if name not in _EXTREMES]
    shown = [[row[k] for k in kept] for row in rows]
    return table_of(f"Scores{over_seeds(*tracking.seeds)}", [header[k] for k in kept], shown)


def _picture(condition: RunsUnderCondition, settings: StatedSettings) -> Picture:
    orbits = [(run.name, *_error_and_rate(run, settings)) for run in condition.runs]
    extremes = "; ".join(
        f"{name} error up to {plain(_most(x), 3)} mm, rate up to {plain(_most(y), 3)} mm/s"
        for name, x, y in orbits
    )
    across = min(_ACROSS, len(orbits))
    down = -(-len(orbits) // across)

    def draw(figure: Any) -> None:
        """Draw each error and its rate in a panel with its own scales, zero as a cross."""
        panels = figure.subplots(down, across, squeeze=False)
        for axes in panels.flat[len(orbits) :]:
            axes.set_axis_off()
        for axes, (name, x, y) in zip(panels.flat, orbits, strict=False):
            axes.axhline(0.0, color=STAND_IN["muted"], linewidth=0.9)
            axes.axvline(0.0, color=STAND_IN["muted"], linewidth=0.9)
            kept = kept_cells(x, y)
            axes.plot(x[kept], y[kept], color=of_controller(name), linewidth=0.8)
            axes.set_title(name, loc="left", fontsize=9.0, pad=3.0)
            axes.locator_params(nbins=5)
        for axes in panels[-1]:
            axes.set_xlabel("e [mm]")
        for axes in panels[:, 0]:
            axes.set_ylabel("de/dt [mm/s]")

    return picture(
        draw,
        key=f"tracking-phase-{condition.number}",
        alt=f"Phase portraits of the drive's error, {condition.name}: {extremes}.",
        caption=f"{condition.name.capitalize()}: rate of the drive's error over the error.",
        height_in=0.5 + 2.0 * down if len(orbits) > 1 else 3.5,
    )


def _error_and_rate(run: TrackedRun, settings: StatedSettings) -> tuple[Floats, Floats]:
    """Return what the filter of the controllers makes of the run's error, shape (n,) each."""
    A, b = error_filter(settings.loop.filter_Hz, 1.0 / settings.sensor.rate_Hz)
    state, error = np.zeros(ORDER), run.columns[X_INV] - run.columns[X_IN]
    both = np.empty((2, error.size))
    for k, e in enumerate(error):
        filtered(state, e, A, b)
        both[:, k] = state[:2]
    return both[0], both[1]


def _most(values: Floats) -> float:
    return float(np.abs(values).max())


def adaptation_part(conditions: tuple[RunsUnderCondition, ...], law: Adaptive) -> Section | None:
    """Return the part, None where no controller adapts."""
    runs = [(c, run) for c in conditions for run in c.runs if run.name == ADAPTIVE]
    if not runs:
        return None
    rows = [
        {
            "parameter": it.symbol,
            "condition": condition.name,
            "at the start": it.ends[0],
            "at the end": it.ends[1],
            "lower bound": f"{it.lowest:g}",
            "upper bound": f"{it.highest:g}",
            "unit": it.unit,
            "time at a bound [%]": f"{100.0 * float(np.mean(it.at_bound)):.0f}",
        }
        for condition, run in runs
        for it in _estimates(run, law)
    ]
    table = table_by_column("Adapted parameters", rows)
    return Section(
        "tracking-adaptation",
        "Adapted parameters",
        (_ADAPTED,),
        tables=(table,),
        pictures=tuple(_estimates_picture(condition, run, law) for condition, run in runs),
        folded=True,
    )


def _estimates(run: TrackedRun, law: Adaptive) -> Iterator[AdaptiveEstimate]:
    names = zip(ESTIMATES, _SYMBOLS, law.lowest, law.highest, strict=True)
    for column, (symbol, unit), lowest, highest in names:
        yield AdaptiveEstimate(symbol, unit, run.columns[column], lowest, highest)


def _estimates_picture(condition: RunsUnderCondition, run: TrackedRun, law: Adaptive) -> Picture:
    estimates = tuple(_estimates(run, law))
    ranges = "; ".join(
        f"{it.symbol} from {' to '.join(it.ends)} {it.unit}, "
        f"bounds {it.lowest:g} and {it.highest:g}"
        for it in estimates
    )

    def draw(figure: Any) -> None:
        """Draw a panel for each estimate, its axis in powers of ten where all is positive."""
        rows = stacked(figure, len(estimates), sharex=True)
        for axes, it in zip(rows, estimates, strict=True):
            line(axes, run.time_s, it.values, color=of_controller(ADAPTIVE), linewidth=1.3)
            for value in (it.lowest, it.highest):
                bound(axes, value)
            if min(it.lowest, float(it.values.min())) > 0.0:
                axes.set_yscale("log")
                axes.yaxis.set_major_formatter("{x:g}")
                axes.yaxis.set_minor_formatter("")
            mark_change(axes, condition.change_s)
            axes.set_title(f"{it.symbol} [{it.unit}]", loc="left", fontsize=9.0, pad=3.0)
        rows[-1].set_xlabel("time [s]")

    return picture(
        draw,
        key=f"tracking-adaptation-{condition.number}",
        alt=f"Adapted parameters over time, {condition.name}: {ranges}.",
        caption=f"{condition.name.capitalize()}: estimates over time, bounds dashed.",
        height_in=4.2,
    )
