"""What the viewer opens with: tabs, of which only those are there that have something to show."""

from collections.abc import Callable, Mapping, Sequence

from tsas_cli.reporting.channels import at_axis
from tsas_cli.reporting.stream.channels import residuals_of, series_of
from tsas_cli.reporting.stream.events import events_of
from tsas_cli.reporting.stream.phases import phases_of
from tsas_cli.reporting.stream.portraits import view_of
from tsas_cli.reporting.stream.recorder.layout import (
    Columns,
    Grid,
    Layout,
    Log,
    Part,
    Rows,
    Series,
    States,
    Tabs,
    Text,
)
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.stream.tracking import tracking_tab

OVERVIEW, DIAGNOSIS = ("about", "overview"), ("about", "diagnosis")
TABS = ("Overview", "Residuals", "Tendon", "Tracking", "Diagnosis")
ALL_RUNS = 12  # beyond which their loops are too small to be seen beside each other
_ACROSS = 4
_LANE = 0.35  # height of the phases over that of a plot


def layout_of(
    runs: Sequence[SeenRun], tendons: Mapping[str, Part], *, diagnosed: bool
) -> Layout:
    """Return the tabs; what was tracked opens on it, all else on the overview.

    `tendons` are the pictures of them, by run; `diagnosed` says whether there is a text on it.
    """
    made = {
        "Overview": _overview(runs),
        "Residuals": _by_run(runs, _residuals),
        "Tendon": _by_run(runs, lambda run: tendons.get(run.id)),
        "Tracking": tracking_tab(runs),
        "Diagnosis": Text("Diagnosis", DIAGNOSIS) if diagnosed else None,
    }
    parts = [Rows([part], name=name) for name in TABS if (part := made[name]) is not None]
    names = [part.name for part in parts]
    on_top = names.index("Tracking") if "Tracking" in names else 0
    return Layout(Tabs(parts, on_top=on_top))


def _overview(runs: Sequence[SeenRun]) -> Part:
    text = Text("Overview", OVERVIEW)
    beside = _by_run(runs, _run, last=_all_runs(runs))
    return text if beside is None else Columns([text, beside], shares=(1.0, 3.0))


def _by_run(
    runs: Sequence[SeenRun],
    make: Callable[[SeenRun], Part | None],
    last: Part | None = None,
) -> Part | None:
    """Return a tab for each run that has something to show."""
    made = ((run.id, make(run)) for run in runs)
    parts: list[Part] = [Rows([part], name=f"run {name}") for name, part in made if part]
    parts += [] if last is None else [last]
    if len(parts) == 1:
        return parts[0]
    return Tabs(parts) if parts else None


def _run(run: SeenRun) -> Part | None:
    series = [Series(at_axis(column), shown) for column, shown in series_of(run).items()]
    rows = _over_phases(run, series)
    if rows is None:
        return None
    beside: list[Part] = [view_of(run, channel) for channel in run.loops]
    if run.segments:
        beside.append(Log("events", [events_of(run)]))
    return Columns([rows, Rows(beside)], shares=(3.0, 2.0)) if beside else rows


def _residuals(run: SeenRun) -> Part | None:
    found = residuals_of(run).items()
    return _over_phases(
        run, [Series(f"measured less simulated: {at_axis(c)}", s) for c, s in found]
    )


def _over_phases(run: SeenRun, series: Sequence[Series]) -> Part | None:
    """Return series under each other, and the phases below, where they are told."""
    if not series:
        return None
    parts: list[Part] = list(series)
    if run.segments:
        parts.append(States("phases", [phases_of(run)]))
    shares = [1.0] * len(series) + [_LANE] * (len(parts) - len(series))
    return Rows(parts, shares=shares)


def _all_runs(runs: Sequence[SeenRun]) -> Part | None:
    """Return the loops of several runs beside each other."""
    loops = [(run, run.loops[0]) for run in runs if run.loops]
    if not 2 <= len(loops) <= ALL_RUNS:
        return None
    return Grid(
        [view_of(run, channel, titled=run.id) for run, channel in loops],
        columns=min(_ACROSS, -(-len(loops) // 2)),
        name="all runs",
    )
