"""How well a wanted force is followed, by whom, and at what cost."""

import numpy as np

from tsas_cli.records.base import ModelFile
from tsas_cli.records.tracking import Spread, TrackingFile
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain, with_spread
from tsas_cli.reporting.tracking import adaptation, curves, portraits
from tsas_cli.reporting.tracking.runs import WANTED, RunsUnderCondition, read_conditions


def section(inputs: Inputs) -> Section | None:
    """Return the section of the closed loop, None where nothing was tracked."""
    tracking = inputs.get(TrackingFile)
    if tracking is None:
        return None
    conditions = read_conditions(inputs, tracking)
    force, error, effort = curves.parts(conditions)
    portrait = portraits.part(conditions, tracking.settings)
    adapted = adaptation.part(conditions, tracking.settings.controllers.adaptive)
    return Section(
        "tracking",
        "Tracking",
        tuple(_intro(tracking, conditions)),
        points=tracking.notes,
        tables=(_scores(tracking),),
        parts=tuple(filter(None, (force, error, portrait, adapted, effort))),
    )


def _intro(tracking: TrackingFile, conditions: tuple[RunsUnderCondition, ...]) -> list[str]:
    said = [_wanted(tracking, conditions[0]), _loop(tracking)]
    said += [_change(condition) for condition in conditions if condition.changes]
    if tracking.gains != "default":
        said.append(f"The gains are {tracking.gains}.")
    said.append(
        "Errors are wanted less true force at the load; outside 2 % is the time in which they are "
        "beyond 2 % of the wanted force's range. Plots show the runs with the first seed."
    )
    return [*said, "Keep in mind:"] if tracking.notes else said


def _wanted(tracking: TrackingFile, condition: RunsUnderCondition) -> str:
    run = condition.runs[0]
    wanted = run.columns[WANTED]
    low, high = plain(float(wanted.min()), 3), plain(float(wanted.max()), 3)
    what = tracking.reference.shape or tracking.reference.file
    return (
        f"The wanted force at the load ({what}) goes from {low} to {high} N, for "
        f"{plain(float(np.ptp(run.time_s)), 3)} s. Simulated, not measured."
    )


def _loop(tracking: TrackingFile) -> str:
    sensor = tracking.settings.sensor
    same = tracking.model == tracking.plant
    tendon = ", with the dynamic chain as its tendon" if tracking.dynamics == "lugre" else ""
    rig = "the same model is the plant" if same else f"the plant is {_name(tracking.plant)}"
    return (
        f"A controller sees x_in alone, {sensor.rate_Hz:g} times a second, with noise of "
        f"{sensor.noise_mm:g} mm and steps of {sensor.step_mm:g} mm. It knows "
        f"{_name(tracking.model)}, and of the drive {tracking.drive.file}; {rig}{tendon}."
    )


def _name(model: ModelFile) -> str:
    return "the data sheet" if model.sha256 is None else model.file


def _change(condition: RunsUnderCondition) -> str:
    changes = ", ".join(
        f"`{c.quantity}` = {c.value:g} "
        + (f"from {c.from_s:g} s on (dotted line)" if c.from_s > 0.0 else "from the start")
        for c in condition.changes
    )
    return f"{condition.name.capitalize()}: the plant has {changes}, which no controller knows."


_COLUMNS = (
    ("RMSE [N]", "rmse_N"),
    ("lowest [N]", "lowest_error_N"),
    ("highest [N]", "highest_error_N"),
    ("outside 2 % [%]", "outside_percent"),
    ("effort [rpm]", "effort_rpm"),
    ("chatter [rpm/s]", "chatter_rpm_per_s"),
)


def _scores(tracking: TrackingFile) -> Table:
    """Return the _scores, with its spread where there is more than one seed."""
    seeds = tracking.seeds[1] - tracking.seeds[0] + 1
    over = f", mean ± standard deviation over {seeds} seeds of noise" if seeds > 1 else ""
    rows = tuple(
        (
            result.controller,
            result.condition,
            *(_cell(getattr(result.scores, key)) for _, key in _COLUMNS),
            _limit(result.scores.at_limit_percent),
        )
        for result in tracking.results
    )
    header = ("controller", "condition", *(title for title, _ in _COLUMNS), "at its limit [%]")
    numeric = frozenset(range(2, len(header)))
    return Table(f"Scores{over}", header, rows, numeric=numeric).without_empty()


def _cell(number: Spread) -> str:
    return with_spread(number.mean, number.sd)


def _limit(number: Spread) -> str:
    """Return how long the motor is at its speed limit; nothing where it never is."""
    return _cell(number) if number.mean else ABSENT
