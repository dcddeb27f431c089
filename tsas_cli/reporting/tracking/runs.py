"""The runs that the plots show, each controller's with the first seed, and their curves."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.recordings.writing import columns_of, result_file
from tsas_cli.records.tracking import ADAPTIVE, ConditionChange, TrackedResult, TrackingFile
from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import bound, legend, line, picture, stacked
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import X_IN
from tsas_cli.reporting.numbers import plain, spanned
from tsas_cli.support.arrays import Floats

_OUTSIDE = 0.02
_NO_NOISE = "The true force is that at the load, without its sensor's noise."
_SCALES = (
    "Wanted less true force at the load. Each panel has a scale of its own; the dashed lines, "
    "where they are in view, are 2 % of the wanted force's range."
)
_EFFORT = (
    "The motor speed u that is asked for, feedforward and controller together. In the table above, "
    "effort is its root mean square, chatter its total variation per second: a line that looks "
    "thick chatters."
)
WANTED, TRUE, ASKED = "f_out_ref_N", "f_out_true_N", "motor_speed_rpm"
X_INV = "x_inv_mm"
ESTIMATES = ("phi1_rpm_s3_per_mm", "phi2_rpm_s_per_mm", "phi3_rpm_s2_per_mm")
_COLUMNS = ("time_s", WANTED, TRUE, ASKED, X_IN, X_INV)


@dataclass(frozen=True)
class TimeCurve:
    """A curve over time: its label, its controller and its values, shape (n,)."""

    label: str
    controller: str
    values: Floats


@dataclass(frozen=True)
class TrackedRun:
    """One run: its scores, and its columns by name, shape (n,) each."""

    result: TrackedResult
    columns: Mapping[str, Floats]

    @property
    def name(self) -> str:
        """The controller."""
        return self.result.controller

    @property
    def time_s(self) -> Floats:
        """Time [s]."""
        return self.columns["time_s"]

    @property
    def error(self) -> Floats:
        """Wanted less true force at the load [N]."""
        return self.columns[WANTED] - self.columns[TRUE]


@dataclass(frozen=True)
class RunsUnderCondition:
    """A condition of the plant, and the runs under it, at least one."""

    name: str
    number: int
    changes: tuple[ConditionChange, ...]
    runs: tuple[TrackedRun, ...]

    @property
    def change_s(self) -> float | None:
        """When within the run the plant changes, or None where it does not."""
        return max((c.from_s for c in self.changes if c.from_s > 0.0), default=None)


def read_conditions(inputs: Inputs, tracking: TrackingFile) -> tuple[RunsUnderCondition, ...]:
    """Read what the plots need, in the order of the file.

    InputError: a run cannot be read, or lacks a column.
    """
    folder = inputs.folders[TrackingFile]
    found: dict[str, list[TrackedRun]] = {}
    for result in tracking.results:
        more = ESTIMATES if result.controller == ADAPTIVE else ()
        followed = TrackedRun(
            result, columns_of(result_file(folder, result.run), (*_COLUMNS, *more))
        )
        found.setdefault(result.condition, []).append(followed)
    return tuple(
        RunsUnderCondition(name, number, tracking.conditions.get(name, ()), tuple(runs))
        for number, (name, runs) in enumerate(found.items())
    )


def curve_parts(conditions: tuple[RunsUnderCondition, ...]) -> Iterator[Section]:
    """Yield the parts of force, error and control effort, one picture for each condition."""
    for key, title, intro, make in (
        ("force", "Wanted and true force", _NO_NOISE, _force),
        ("error", "Tracking error", _SCALES, _error),
        ("effort", "Control effort", _EFFORT, _effort),
    ):
        pictures = tuple(make(condition, f"tracking-{key}") for condition in conditions)
        yield Section(f"tracking-{key}", title, (intro,), pictures=pictures)


def _force(condition: RunsUnderCondition, key: str) -> Picture:
    wanted = condition.runs[0].columns[WANTED]

    def draw(
        figure: Any, time_s: Floats, curves: Sequence[TimeCurve], change_s: float | None
    ) -> None:
        """Draw what is wanted, wide and grey, and all curves over it."""
        axes = figure.add_subplot()
        line(axes, time_s, wanted, color=STAND_IN["measured"], linewidth=3.2, label="wanted")
        for curve in curves:
            colour = of_controller(curve.controller)
            line(axes, time_s, curve.values, color=colour, linewidth=1.1, label=curve.label)
        mark_change(axes, change_s)
        axes.set(xlabel="time [s]", ylabel="force at the load [N]")
        legend(figure)

    return _picture(
        condition,
        [TimeCurve(run.name, run.name, run.columns[TRUE]) for run in condition.runs],
        draw,
        key=key,
        what=("Force at the load", f"newton: wanted {spanned(wanted)}"),
        caption="wanted force, and what each controller gives",
        height_in=3.5,
    )


def _error(condition: RunsUnderCondition, key: str) -> Picture:
    band = _OUTSIDE * float(np.ptp(condition.runs[0].columns[WANTED]))
    return _picture(
        condition,
        [TimeCurve(run.name, run.name, run.error) for run in condition.runs],
        partial(draw_panels, label="error [N]", band=band),
        key=key,
        what=("Tracking error", "newton"),
        caption="wanted less true force over time",
        height_in=_panels_in(condition),
    )


def _effort(condition: RunsUnderCondition, key: str) -> Picture:
    chatter = (plain(run.result.scores.chatter_rpm_per_s.mean, 3) for run in condition.runs)
    return _picture(
        condition,
        [
            TimeCurve(f"{run.name}, chatter {rate} rpm/s", run.name, run.columns[ASKED])
            for run, rate in zip(condition.runs, chatter, strict=True)
        ],
        partial(draw_panels, label="u [rpm]", same_scale=True),
        key=key,
        what=("Motor speed asked for", "rpm"),
        caption="motor speed asked for over time",
        height_in=_panels_in(condition),
    )


def _picture(
    condition: RunsUnderCondition,
    curves: Sequence[TimeCurve],
    draw: Callable[..., Any],
    *,
    key: str,
    what: tuple[str, str],
    caption: str,
    height_in: float,
) -> Picture:
    """Return a condition's curves; `what` is shown, and in which unit."""
    ranges = "; ".join(f"{curve.label}, {spanned(curve.values)}" for curve in curves)
    time_s, change_s = condition.runs[0].time_s, condition.change_s
    return picture(
        partial(draw, time_s=time_s, curves=curves, change_s=change_s),
        key=f"{key}-{condition.number}",
        alt=f"{what[0]} over time, {condition.name}, in {what[1]}: {ranges}.",
        caption=f"{condition.name.capitalize()}: {caption}.",
        height_in=height_in,
    )


def _panels_in(condition: RunsUnderCondition) -> float:
    panels = len(condition.runs)
    return 0.6 + (1.15 * panels if panels > 1 else 2.4)


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
    rows = stacked(figure, len(curves), sharex=True, sharey=same_scale)
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
