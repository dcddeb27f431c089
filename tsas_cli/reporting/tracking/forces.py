"""Wanted and true force over time, and the error of each controller."""

from functools import partial

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import plain, spanned
from tsas_cli.reporting.tracking.over_time import TimeCurve, draw_panels, draw_together, panels_in
from tsas_cli.reporting.tracking.runs import TRUE, WANTED, RunsUnderCondition, TrackedRun

Floats = npt.NDArray[np.float64]
_OUTSIDE = 0.02
_SCALES = (
    "Wanted less true force at the load. Each panel has a scale of its own; the dashed lines, "
    "where they are in view, are 2 % of the wanted force's range."
)


def followed(conditions: tuple[RunsUnderCondition, ...]) -> Section:
    """Return the part that shows wanted and true force, one picture for each condition."""
    return Section(
        "tracking-force",
        "Wanted and true force",
        ("The true force is that at the load, without its sensor's noise.",),
        pictures=tuple(map(_force, conditions)),
    )


def errors(conditions: tuple[RunsUnderCondition, ...]) -> Section:
    """Return the part that shows the errors, one picture for each condition."""
    return Section(
        "tracking-error", "Tracking error", (_SCALES,), pictures=tuple(map(_error, conditions))
    )


def _force(condition: RunsUnderCondition) -> Picture:
    first = condition.runs[0]
    wanted = first.columns[WANTED]
    curves = [TimeCurve(run.name, run.name, run.columns[TRUE]) for run in condition.runs]
    spans = "; ".join(f"{c.label} {spanned(c.values)}" for c in curves)
    return picture(
        partial(
            draw_together,
            time_s=first.time_s,
            wanted=wanted,
            curves=curves,
            label="force at the load [N]",
            change_s=condition.change_s,
        ),
        key=f"tracking-force-{condition.number}",
        alt=f"Force at the load over time, {condition.name}, in newton: wanted "
        f"{spanned(wanted)}; {spans}.",
        caption=f"{condition.name.capitalize()}: wanted force, and what each controller gives.",
    )


def _error(condition: RunsUnderCondition) -> Picture:
    first = condition.runs[0]
    curves = [_error_curve(run) for run in condition.runs]
    spans = "; ".join(f"{c.label}, {spanned(c.values)}" for c in curves)
    return picture(
        partial(
            draw_panels,
            time_s=first.time_s,
            curves=curves,
            label="error [N]",
            change_s=condition.change_s,
            band=_OUTSIDE * float(np.ptp(first.columns[WANTED])),
        ),
        key=f"tracking-error-{condition.number}",
        alt=f"Tracking error over time, {condition.name}, in newton: {spans}.",
        caption=f"{condition.name.capitalize()}: wanted less true force over time.",
        height_in=panels_in(len(curves)),
    )


def _error_curve(run: TrackedRun) -> TimeCurve:
    error = run.error
    rmse = plain(float(np.sqrt(np.mean(error**2))), 3)
    return TimeCurve(f"{run.name}, RMSE {rmse} N", run.name, error)
