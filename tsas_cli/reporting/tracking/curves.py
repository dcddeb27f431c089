"""Curves over time by condition: the wanted and the true force, the error, the motor's speed."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import plain, spanned
from tsas_cli.reporting.tracking.over_time import TimeCurve, draw_panels, draw_together, panels_in
from tsas_cli.reporting.tracking.runs import ASKED, TRUE, WANTED, RunsUnderCondition, TrackedRun

_OUTSIDE = 0.02
_SCALES = (
    "Wanted less true force at the load. Each panel has a scale of its own; the dashed lines, "
    "where they are in view, are 2 % of the wanted force's range."
)
_EFFORT = (
    "The motor speed u that is asked for, feedforward and controller together. In the table above, "
    "effort is its root mean square, chatter its total variation per second: a line that looks "
    "thick chatters."
)


def parts(conditions: tuple[RunsUnderCondition, ...]) -> tuple[Section, Section, Section]:
    """Return the parts of force, error and control effort, one picture for each condition."""

    def part(name: str, title: str, intro: str, make: Callable[..., Picture]) -> Section:
        pictures = tuple(map(make, conditions))
        return Section(f"tracking-{name}", title, (intro,), pictures=pictures)

    without_noise = "The true force is that at the load, without its sensor's noise."
    return (
        part("force", "Wanted and true force", without_noise, _force),
        part("error", "Tracking error", _SCALES, _error),
        part("effort", "Control effort", _EFFORT, _effort),
    )


def _force(condition: RunsUnderCondition) -> Picture:
    wanted = condition.runs[0].columns[WANTED]
    curves = [TimeCurve(run.name, run.name, run.columns[TRUE]) for run in condition.runs]
    return _picture(
        condition,
        curves,
        partial(draw_together, wanted=wanted, label="force at the load [N]"),
        key="force",
        what=("Force at the load", f"newton: wanted {spanned(wanted)}"),
        caption="wanted force, and what each controller gives",
        height_in=3.5,
    )


def _error(condition: RunsUnderCondition) -> Picture:
    band = _OUTSIDE * float(np.ptp(condition.runs[0].columns[WANTED]))
    curves = [_error_curve(run) for run in condition.runs]
    return _picture(
        condition,
        curves,
        partial(draw_panels, label="error [N]", band=band),
        key="error",
        what=("Tracking error", "newton"),
        caption="wanted less true force over time",
        height_in=panels_in(len(curves)),
    )


def _effort(condition: RunsUnderCondition) -> Picture:
    curves = [_effort_curve(run) for run in condition.runs]
    return _picture(
        condition,
        curves,
        partial(draw_panels, label="u [rpm]", same_scale=True),
        key="effort",
        what=("Motor speed asked for", "rpm"),
        caption="motor speed asked for over time",
        height_in=panels_in(len(curves)),
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
    drawn = partial(
        draw, time_s=condition.runs[0].time_s, curves=curves, change_s=condition.change_s
    )
    said = "; ".join(f"{curve.label}, {spanned(curve.values)}" for curve in curves)
    return picture(
        drawn,
        key=f"tracking-{key}-{condition.number}",
        alt=f"{what[0]} over time, {condition.name}, in {what[1]}: {said}.",
        caption=f"{condition.name.capitalize()}: {caption}.",
        height_in=height_in,
    )


def _error_curve(run: TrackedRun) -> TimeCurve:
    error = run.error
    rmse = plain(float(np.sqrt(np.mean(error**2))), 3)
    return TimeCurve(f"{run.name}, RMSE {rmse} N", run.name, error)


def _effort_curve(run: TrackedRun) -> TimeCurve:
    chatter = plain(run.result.scores.chatter_rpm_per_s.mean, 3)
    return TimeCurve(f"{run.name}, chatter {chatter} rpm/s", run.name, run.columns[ASKED])
