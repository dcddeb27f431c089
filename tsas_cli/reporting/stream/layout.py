"""What the viewer opens with: tabs, of which only those are there that have something to show."""

from collections.abc import Callable, Mapping, Sequence

import rerun.blueprint as rrb
from rerun.blueprint import Blueprint, Container, Grid, Horizontal, Tabs, Vertical, View

from tsas_cli.reporting.names import X_IN, at_axis
from tsas_cli.reporting.stream.channels import (
    ERROR,
    FORCE,
    SPEED,
    STATES,
    entities_of,
    faults_of,
    residuals_of,
    view_of,
)
from tsas_cli.reporting.stream.recorder import T
from tsas_cli.reporting.stream.seen import MEASURED, WANTED, SeenRun
from tsas_cli.reporting.stream.tendon import view_of_tendon

Part = Container | View

OVERVIEW = "/about/overview"
ALL_RUNS = 12  # beyond which their loops are too small to be seen beside each other
_ACROSS = 4
_ORDER = ("f_in_N", "f_out_N", X_IN, "x_out_mm")  # what is looked at first
_TALL, _LANE = 1.6, 0.8  # height of the first plot, and of the phases, over that of the others
_LINKED = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)  # all show the same stretch


def layout_of(runs: Sequence[SeenRun]) -> Blueprint:
    """Return the tabs; what was tracked opens on it, all else on the overview."""
    words = rrb.TextDocumentView(name="Overview", contents=f"+ {OVERVIEW}")
    beside = _by_run(runs, _run, last=_all_runs(runs))
    made = {
        "Overview": Horizontal(words, beside, column_shares=(1.0, 3.0)) if beside else words,
        "Residuals": _by_run(
            runs, lambda run: _over_phases(run, residuals_of(run), "measured less simulated, ")
        ),
        "Tendon": _by_run(runs, view_of_tendon),
        "Tracking": _tracking(runs),
    }
    parts = [Vertical(part, name=name) for name, part in made.items() if part is not None]
    moves = made["Tendon"] is not None or any(run.loops for run in runs)
    return Blueprint(
        Tabs(*parts, active_tab=len(parts) - 1 if made["Tracking"] else 0),
        rrb.TimePanel(
            state="collapsed",
            timeline=T,
            loop_mode="All",
            play_state="Playing" if moves else "Paused",
        ),
        auto_layout=False,
        auto_views=False,
        collapse_panels=True,
    )


def series(name: str, entities: Sequence[str]) -> View:
    """Return series over time."""
    return rrb.TimeSeriesView(
        name=name,
        contents=[f"+ {entity}" for entity in entities],
        axis_x=_LINKED,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop),
    )


def _by_run(
    runs: Sequence[SeenRun],
    make: Callable[[SeenRun], Part | None],
    last: Part | None = None,
) -> Part | None:
    """Return a tab for each run that has something to show."""
    made = ((run.id, make(run)) for run in runs)
    parts: list[Part] = [Vertical(part, name=f"run {name}") for name, part in made if part]
    return _tabs(parts if last is None else [*parts, last])


def _tabs(parts: Sequence[Part]) -> Part | None:
    """Return parts as tabs, a single one as it is."""
    if len(parts) > 1:
        return Tabs(*parts, active_tab=0)
    return parts[0] if parts else None


def _run(run: SeenRun) -> Part | None:
    rows = _over_phases(run, entities_of(run))
    beside: list[Part] = [view_of(run, channel) for channel in run.loops]
    if faults_of(run):
        faults = f"+ {run.entity('faults')}"
        beside.append(rrb.TextLogView(name="faults", contents=faults))
    if rows is None or not beside:
        return rows
    return Horizontal(rows, Vertical(*beside), column_shares=(3.0, 2.0))


def _over_phases(run: SeenRun, shown: Mapping[str, Sequence[str]], what: str = "") -> Part | None:
    """Return series under each other, and the phases below, where they are known."""
    columns = sorted(shown, key=lambda name: _ORDER.index(name) if name in _ORDER else 9)
    parts: list[Part] = [series(what + at_axis(column), shown[column]) for column in columns]
    if not parts:
        return None
    shares = [_TALL] + [1.0] * (len(parts) - 1)
    if run.segments:
        phases = f"+ {run.entity('phase')}"
        parts.append(rrb.StateTimelineView(name="phases", contents=phases, time_view=_LINKED))
        shares.append(_LANE)
    return Vertical(*parts, row_shares=shares)


def _all_runs(runs: Sequence[SeenRun]) -> Part | None:
    loops = [(run, run.loops[0]) for run in runs if run.loops]
    if not 2 <= len(loops) <= ALL_RUNS:
        return None
    return Grid(
        *(view_of(run, channel, titled=run.id) for run, channel in loops),
        grid_columns=min(_ACROSS, -(-len(loops) // 2)),
        name="all runs",
    )


def _tracking(runs: Sequence[SeenRun]) -> Part | None:
    """Return a part for each condition, its runs over each other, None where nothing is tracked."""
    conditions: dict[str, list[SeenRun]] = {}
    for run in runs:
        if run.tracked is not None:
            conditions.setdefault(run.tracked.condition, []).append(run)
    return _tabs([_condition(name, found) for name, found in conditions.items()])


def _condition(name: str, runs: Sequence[SeenRun]) -> Part:
    true = [run.entity(FORCE, "true") for run in runs]
    followed = [
        series("force at the load [N]", [runs[0].entity(FORCE, WANTED), *true]),
        series("error: wanted less true force [N]", [run.entity(ERROR) for run in runs]),
        series("motor speed, as asked for [rpm]", [run.entity(SPEED, MEASURED) for run in runs]),
    ]
    states = [
        series(title, entities)
        for column, title in STATES.items()
        if (entities := [run.entity(column) for run in runs if column in run.file.names])
    ]
    columns = [Vertical(*views) for views in (followed, states) if views]
    return Horizontal(*columns, name=name)
