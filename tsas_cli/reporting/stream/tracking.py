"""A closed loop: wanted and true force, its error, what the motor is asked for, and the estimates.

Entities belong to the run; what several runs have in common lies over each other by condition.
"""

from collections.abc import Sequence

from rerun.blueprint import Horizontal, Tabs, Vertical, View

from tsas_cli.reporting.colours import CONTROLLERS, dark
from tsas_cli.reporting.stream import seen
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.seen import MEASURED, SeenRun
from tsas_cli.reporting.stream.views import Part, series
from tsas_cli.reporting.tracking.runs import TRUE, WANTED

FORCE, ERROR, SPEED = "f_out_N", "tracking_error_N", "motor_speed_rpm"


STATES = {  # that a controller keeps: the axis of each column
    "error_sum_mm_s": "sum of the error ∫e dt [mm s]",
    "sliding_distance_mm_per_s2": "sliding variable s [mm/s²]",
    "phi1_rpm_s3_per_mm": "estimate φ̂1 [rpm s³/mm]",
    "phi2_rpm_s_per_mm": "estimate φ̂2 [rpm s/mm]",
    "phi3_rpm_s2_per_mm": "estimate φ̂3 [rpm s²/mm]",
    "error_estimate_mm": "estimated error [mm]",
    "disturbance_rpm": "estimated disturbance d [rpm]",
}


def record_tracking(recorder: Recorder, run: SeenRun) -> None:
    """Record what a tracked run holds beside its sensors; nothing for any other run.

    Raises
    ------
    InputError
        A column is missing or cannot be read.
    """
    if run.tracked is None:
        return
    name = run.tracked.controller
    shown = dark(name if name in CONTROLLERS else "unknown")
    wanted, true = run.file.read(WANTED), run.file.read(TRUE)
    kept = {true_of(run): true, run.entity(ERROR): wanted - true}
    kept |= {run.entity(state): run.file.read(state) for state in STATES if state in run.file.names}
    for entity, values in kept.items():
        recorder.line(entity, name, shown)
        recorder.scalars(entity, run.times, values)
    # In place of "measured": a controller asks for it.
    recorder.line(run.entity(SPEED, MEASURED), name, shown)


def true_of(run: SeenRun) -> Entity:
    """Return the entity of the true force."""
    return run.entity(FORCE, "true")


def tracking_tab(runs: Sequence[SeenRun]) -> Part | None:
    """Return a part for each condition, its runs over each other, None where nothing is tracked."""
    conditions: dict[str, list[SeenRun]] = {}
    for run in runs:
        if run.tracked is not None:
            conditions.setdefault(run.tracked.condition, []).append(run)
    if not conditions:
        return None
    parts = [_condition(name, found) for name, found in conditions.items()]
    return parts[0] if len(parts) == 1 else Tabs(*parts, active_tab=0)


def _condition(name: str, runs: Sequence[SeenRun]) -> Part:
    columns = [Vertical(*views) for views in (_followed(runs), _states(runs)) if views]
    return Horizontal(*columns, name=name)


def _followed(runs: Sequence[SeenRun]) -> list[View]:
    errors = [run.entity(ERROR) for run in runs]
    speeds = [run.entity(SPEED, MEASURED) for run in runs]
    forces = [runs[0].entity(FORCE, seen.WANTED), *map(true_of, runs)]
    return [
        series("force at the load [N]", forces),
        series("error: wanted less true force [N]", errors, legend=False),
        series("motor speed, as asked for [rpm]", speeds, legend=False),
    ]


def _states(runs: Sequence[SeenRun]) -> list[View]:
    views = []
    for column, title in STATES.items():
        if entities := [run.entity(column) for run in runs if column in run.file.names]:
            views.append(series(title, entities))
    return views
