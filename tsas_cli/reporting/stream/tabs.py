"""What the viewer opens with: tabs, of which only those are there that have something to show."""

from collections.abc import Callable, Mapping, Sequence

from rerun.blueprint import Blueprint, Grid, Horizontal, Tabs, Vertical

from tsas_cli.reporting.channels import at_axis
from tsas_cli.reporting.stream.channels import residuals_of, series_of
from tsas_cli.reporting.stream.events import REVERSALS, events_of, happens, phases_of
from tsas_cli.reporting.stream.portraits import view_of
from tsas_cli.reporting.stream.recorder import Entity
from tsas_cli.reporting.stream.seen import X_IN, SeenRun
from tsas_cli.reporting.stream.tendon.content import view_of_tendon
from tsas_cli.reporting.stream.tracking import FORCE, tracking_tab, true_of
from tsas_cli.reporting.stream.views import Part, laid_out, log, series, states, text

OVERVIEW, DIAGNOSIS = ("about", "overview"), ("about", "diagnosis")
ALL_RUNS = 12  # beyond which their loops are too small to be seen beside each other
_ACROSS = 4
_ORDER = ("f_in_N", "f_out_N", "x_in_mm", "x_out_mm")  # what is looked at first
_TALL, _LANE = 1.6, 0.8  # height of the first plot, and of the phases, over that of the others
_LOG = 0.6  # height of the events over that of a loop


def layout_of(runs: Sequence[SeenRun], *, diagnosed: bool) -> Blueprint:
    """Return the tabs; what was tracked opens on it, all else on the overview.

    `diagnosed` says whether there is a text on it.
    """
    made = {
        "Overview": _overview(runs),
        "Residuals": _by_run(runs, _residuals),
        "Tendon": _by_run(runs, view_of_tendon),
        "Tracking": tracking_tab(runs),
        "Diagnosis": text("Diagnosis", DIAGNOSIS) if diagnosed else None,
    }
    parts = [Vertical(part, name=name) for name, part in made.items() if part is not None]
    names = [part.name for part in parts]
    on_top = names.index("Tracking") if "Tracking" in names else 0
    moves = made["Tendon"] is not None or any(run.loops for run in runs)
    return laid_out(Tabs(*parts, active_tab=on_top), plays=moves)


def _overview(runs: Sequence[SeenRun]) -> Part:
    words = text("Overview", OVERVIEW)
    beside = _by_run(runs, _run, last=_all_runs(runs))
    return words if beside is None else Horizontal(words, beside, column_shares=(1.0, 3.0))


def _by_run(
    runs: Sequence[SeenRun],
    make: Callable[[SeenRun], Part | None],
    last: Part | None = None,
) -> Part | None:
    """Return a tab for each run that has something to show."""
    made = ((run.id, make(run)) for run in runs)
    parts: list[Part] = [Vertical(part, name=f"run {name}") for name, part in made if part]
    parts += [] if last is None else [last]
    if len(parts) == 1:
        return parts[0]
    return Tabs(*parts, active_tab=0) if parts else None


def _run(run: SeenRun) -> Part | None:
    shown = series_of(run)
    if X_IN in shown and run.segments:
        shown[X_IN].append(run.entity(X_IN, REVERSALS))
    if run.tracked is not None:
        shown[FORCE].append(true_of(run))
    rows = _over_phases(run, shown)
    if rows is None:
        return None
    beside: list[Part] = [view_of(run, channel) for channel in run.loops]
    shares = [1.0] * len(beside)
    if happens(run):
        beside.append(log("events", [events_of(run)]))
        shares.append(_LOG)
    if not beside:
        return rows
    return Horizontal(rows, Vertical(*beside, row_shares=shares), column_shares=(3.0, 2.0))


def _residuals(run: SeenRun) -> Part | None:
    return _over_phases(run, residuals_of(run), "measured less simulated, ")


def _over_phases(
    run: SeenRun, shown: Mapping[str, Sequence[Entity]], what: str = ""
) -> Part | None:
    """Return series under each other, and the phases below, where they are known.

    A legend stands where a series has a name that is in no plot above.
    """
    parts: list[Part] = []
    named: set[str] = set()
    for column in sorted(shown, key=_rank):
        keys = {entity[-1] for entity in shown[column]}
        parts.append(series(what + at_axis(column), shown[column], legend=not keys <= named))
        named |= keys
    if not parts:
        return None
    shares = [_TALL] + [1.0] * (len(parts) - 1)
    if run.segments:
        parts.append(states("phases", [phases_of(run)]))
        shares.append(_LANE)
    return Vertical(*parts, row_shares=shares)


def _rank(column: str) -> int:
    return _ORDER.index(column) if column in _ORDER else len(_ORDER)


def _all_runs(runs: Sequence[SeenRun]) -> Part | None:
    """Return the loops of several runs beside each other."""
    loops = [(run, run.loops[0]) for run in runs if run.loops]
    if not 2 <= len(loops) <= ALL_RUNS:
        return None
    return Grid(
        *(view_of(run, channel, titled=run.id) for run, channel in loops),
        grid_columns=min(_ACROSS, -(-len(loops) // 2)),
        name="all runs",
    )
