"""Find runs among those of many datasets."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tsas_cli.collection.query import QueryResult, connected, run_query
from tsas_cli.records.result import Result, Table, heading, notes
from tsas_cli.stages.given import at_least, listed, paths_of
from tsas_cli.support.steps import NO_PROGRESS, Steps

if TYPE_CHECKING:
    import pandas as pd

SHOWN = (
    "folder",
    "run",
    "started",
    "load",
    "total_bend_rad",
    "preload_N",
    "rows",
    "rate_Hz",
    "channels",
    "tags",
    "verdict",
    "causes",
)
TIMES = frozenset({"started", "diagnosed"})
MOST_SHOWN = 50  # runs in a table for which no limit was asked
MOST_NOTES = 10


@dataclass(frozen=True, repr=False, eq=False)
class RunsResult(Result):
    """The runs that a query names."""

    found: QueryResult  # the columns that were asked for, and a row of values for each run
    shown: Sequence[str]  # the columns of the table

    @property
    def paths(self) -> tuple[str, ...]:
        """The folders of their datasets, each once."""
        return self.found.folders

    def frame(self) -> "pd.DataFrame":
        """Return a row for each run, as a pandas table; `tags` is a dict."""
        import pandas as pd

        frame = pd.DataFrame(self.found.rows, columns=list(self.found.columns))
        for name in TIMES.intersection(frame.columns):
            frame[name] = pd.to_datetime(frame[name])
        return frame

    def tables(self) -> list[Table]:
        """Return the runs; a column that is empty in all of them is left out."""
        limited = self.summary["limit"] is not None
        rows = self.found.rows[: None if limited else MOST_SHOWN]
        cells = [[_cell(value) for value in row] for row in rows]
        names = self.found.columns
        places = [names.index(name) for name in self.shown]
        filled = [k for k in places if any(row[k] for row in cells)]
        header = [names[k] for k in filled]
        title = f"{self.found.fitting} of {self.found.all_runs} runs"
        if len(rows) < self.found.fitting:
            title += f", the first {len(rows)} of them"
        return [(title, header, [[row[k] for k in filled] for row in cells])]

    def sentences(self) -> list[str]:
        """Return which files could not be read."""
        problems = self.found.problems
        more = len(problems) - MOST_NOTES
        said = problems[:MOST_NOTES] + ([f"and {more} more, in --json"] if more > 0 else [])
        return notes(said)


def runs(
    query: str = "",
    folders: str | Path | Iterable[str | Path] = ".",
    *,
    columns: Sequence[str] = (),
    sort: Sequence[str] = (),
    limit: int | None = None,
    step: Steps = NO_PROGRESS,
) -> RunsResult:
    """Find runs among those of all datasets below some folders.

    Parameters
    ----------
    query
        A condition in SQL over the columns (docs/runs.md), such as
        `total_bend_rad > 3 and f_out in channels and started >= 2026-01`; all runs without it.
    folders
        Where to look; the current folder without it.
    columns
        What is shown of each run; all of it without them.
    sort
        Columns to sort by, with a minus before the name the other way round.
    limit
        How many runs at most.
    step
        Called once for each file that is new or has changed.

    Returns
    -------
    RunsResult
        `.frame()` is a pandas table with a row per run, `.paths` are the datasets' folders.

    Raises
    ------
    InputError
        The query is no condition on these columns, a folder is none, or duckdb is not installed.
    """
    named = paths_of(folders)
    if limit is not None:
        at_least(0, limit, "limit")
    shown, order = tuple(listed(columns)), tuple(listed(sort))
    with connected() as connection:
        from tsas_cli.collection.index import index_of

        index = index_of(named, connection, step)
        found = run_query(connection, index, query, columns=shown, sort=order, limit=limit)
    summary = heading("runs") | {
        "query": query,
        "folders": [str(folder) for folder in named],
        "limit": limit,
        "fitting": found.fitting,
        "all_runs": found.all_runs,
        "runs": [
            {
                name: value.isoformat() if isinstance(value, datetime) else value
                for name, value in zip(found.columns, row, strict=True)
            }
            for row in found.rows
        ],
        "problems": found.problems,
    }
    return RunsResult(summary, None, found, shown or SHOWN)


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, datetime):
        return value.isoformat(sep=" ", timespec="minutes")
    if isinstance(value, dict):
        return ", ".join(f"{key}={each}" for key, each in value.items())
    return ", ".join(value) if isinstance(value, list) else str(value)
