"""A closed loop: wanted and true force, its error, what the motor is asked for, and the estimates.

Entities belong to the run; what several runs have in common lies over each other by condition.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from tsas_cli.reporting.colours import CONTROLLERS
from tsas_cli.reporting.stream import seen
from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.recorder.views import (
    Horizontal,
    Part,
    Tabs,
    Vertical,
    View,
    series,
)
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.tracking.runs import TRUE, WANTED

FORCE, ERROR, SPEED = "f_out_N", "tracking_error_N", "motor_speed_rpm"


@dataclass(frozen=True)
class Told:
    """A column that a controller remembers: where it is shown, and its axis."""

    column: str
    title: str


TOLD = (
    Told("error_sum_mm_s", "sum of the error ∫e dt [mm s]"),
    Told("sliding_distance_mm_per_s2", "sliding variable s [mm/s²]"),
    Told("phi1_rpm_s3_per_mm", "estimate φ̂1 [rpm s³/mm]"),
    Told("phi2_rpm_s_per_mm", "estimate φ̂2 [rpm s/mm]"),
    Told("phi3_rpm_s2_per_mm", "estimate φ̂3 [rpm s²/mm]"),
    Told("error_estimate_mm", "estimated error [mm]"),
    Told("disturbance_rpm", "estimated disturbance d [rpm]"),
)


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
    shown = colour(name if name in CONTROLLERS else "unknown")
    wanted, true = run.file.read(WANTED), run.file.read(TRUE)
    series = {true_of(run): true, run.entity(ERROR): wanted - true}
    series |= {run.entity(t.column): run.file.read(t.column) for t in told_by(run)}
    for entity, values in series.items():
        recorder.line(entity, name, shown)
        recorder.scalars(entity, run.times, values)
    recorder.line(speed_of(run), name, shown)  # in place of "measured": a controller asks for it


def told_by(run: SeenRun) -> list[Told]:
    """Return what the run's controller remembers."""
    return [told for told in TOLD if run.tracked is not None and told.column in run.file.names]


def wanted_of(run: SeenRun) -> Entity:
    """Return the entity of the wanted force."""
    return run.entity(FORCE, seen.WANTED)


def true_of(run: SeenRun) -> Entity:
    """Return the entity of the true force."""
    return run.entity(FORCE, "true")


def speed_of(run: SeenRun) -> Entity:
    """Return the entity of the motor's speed."""
    return run.entity(SPEED, seen.MEASURED)


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
    columns = [Vertical(*views) for views in (_followed(runs), _told(runs)) if views]
    return Horizontal(*columns, name=name)


def _followed(runs: Sequence[SeenRun]) -> list[View]:
    errors, speeds = [run.entity(ERROR) for run in runs], list(map(speed_of, runs))
    return [
        series("force at the load [N]", [wanted_of(runs[0]), *map(true_of, runs)]),
        series("error: wanted less true force [N]", errors, legend=False),
        series("motor speed, as asked for [rpm]", speeds, legend=False),
    ]


def _told(runs: Sequence[SeenRun]) -> list[View]:
    shown = ((one, [run.entity(one.column) for run in runs if one in told_by(run)]) for one in TOLD)
    return [series(told.title, entities) for told, entities in shown if entities]
