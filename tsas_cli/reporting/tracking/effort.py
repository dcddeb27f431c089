"""What a controller asks the motor for, over time."""

from functools import partial

from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.tracking.over_time import TimeCurve, draw_panels, panels_in
from tsas_cli.reporting.tracking.runs import ASKED, RunsUnderCondition, TrackedRun

_WHAT = (
    "The motor speed u that is asked for, feedforward and controller together. In the table above, "
    "effort is its root mean square, chatter its total variation per second: a line that looks "
    "thick chatters."
)


def part(conditions: tuple[RunsUnderCondition, ...]) -> Section:
    """Return the part, one picture for each condition."""
    pictures = tuple(map(_picture, conditions))
    return Section("tracking-effort", "Control effort", (_WHAT,), pictures=pictures)


def _picture(condition: RunsUnderCondition) -> Picture:
    first = condition.runs[0]
    curves = [_curve(run) for run in condition.runs]
    said = "; ".join(
        f"{run.name} {plain(float(c.values.min()), 3)} to {plain(float(c.values.max()), 3)}, "
        f"effort {plain(run.result.scores.effort_rpm.mean, 3)}"
        for run, c in zip(condition.runs, curves, strict=True)
    )
    return picture(
        partial(
            draw_panels,
            time_s=first.time_s,
            curves=curves,
            label="u [rpm]",
            change_s=condition.change_s,
            same_scale=True,
        ),
        key=f"tracking-effort-{condition.number}",
        alt=f"Motor speed asked for over time, {condition.name}, in rpm: {said}.",
        caption=f"{condition.name.capitalize()}: motor speed asked for over time.",
        height_in=panels_in(len(curves)),
    )


def _curve(run: TrackedRun) -> TimeCurve:
    chatter = plain(run.result.scores.chatter_rpm_per_s.mean, 3)
    return TimeCurve(f"{run.name}, chatter {chatter} rpm/s", run.name, run.columns[ASKED])
