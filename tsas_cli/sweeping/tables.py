"""Tables of a sweep: one row per task, one row per parameter, and the printed tables."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.records.result import Table
from tsas_cli.sweeping.outcome import Row, TaskOutcome
from tsas_cli.sweeping.tasks import Task

MOST_SHOWN = 20  # failed tasks in the printed table; the file holds all
ENDS = ("_low", "_high", "_sd")  # of figures that are in the file only
COUNTED = ("verdict", "causes", "codes")  # results that are words, whose frequencies are printed


def rows_of(tasks: Sequence[Task], outcomes: Sequence[TaskOutcome]) -> list[Row]:
    """Return one row per task: its name, input, state and results."""
    return [
        {
            "task": task.key,
            **({"dataset": task.source.name} if task.source else {}),
            **({"run": task.source.run} if task.source and task.source.run else {}),
            **task.point,
            "state": outcome["state"],
            "error": outcome.get("error"),
            **outcome.get("results", {}),
        }
        for task, outcome in zip(tasks, outcomes, strict=True)
    ]


def parameter_rows(tasks: Sequence[Task], outcomes: Sequence[TaskOutcome]) -> list[Row]:
    """Return one row for each parameter of each task, with interval, unit and bound flag."""
    return [
        {
            "task": task.key,
            **({"dataset": task.source.name} if task.source else {}),
            **task.point,
            **{key if key != "run" else "of_run": value for key, value in parameter.items()},
        }
        for task, outcome in zip(tasks, outcomes, strict=True)
        for parameter in outcome.get("parameters", [])
    ]


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as Parquet; a column of mixed types is text."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: _column([row.get(name) for row in rows]) for name in names}
    pq.write_table(pa.table(columns), path, compression="zstd")


def _column(values: list[Any]) -> pa.Array:
    try:
        return pa.array(values)
    except (pa.ArrowInvalid, pa.ArrowTypeError):
        return pa.array([None if value is None else str(value) for value in values])


def printed(rows: Sequence[Row], varied: Sequence[str], title: str) -> list[Table]:
    """Return the printed tables: ranges of figures, frequencies of words, and failed tasks."""
    named = {"task", "dataset", "run", "state", "error", *varied}
    done = [row for row in rows if row["state"] == "done"]
    names = [name for name in dict.fromkeys(n for row in done for n in row) if name not in named]
    printed_names = [name for name in names if not name.endswith(ENDS)]
    spans = [_span(name, [row.get(name) for row in done]) for name in printed_names]
    header = ("result", "tasks", "lowest", "median", "highest")
    tables: list[Table] = [(title, header, [span for span in spans if span is not None])]
    for name in COUNTED:
        if name in names:
            many = Counter(row.get(name) or "none" for row in done).most_common()
            tables.append(("", (name, "tasks"), [(word, str(n)) for word, n in many]))
    failed = [row for row in rows if row["state"] == "failed"]
    if failed:
        more = f", the first {MOST_SHOWN}" if len(failed) > MOST_SHOWN else ""
        shown = [(_input(row, varied), row["error"]) for row in failed[:MOST_SHOWN]]
        tables.append((f"failed {len(failed)}{more}", ("input", "error"), shown))
    return tables


def _input(row: Row, varied: Iterable[str]) -> str:
    """Return the dataset, run and values that identify a task."""
    source = [str(row[name]) for name in ("dataset", "run") if name in row]
    return ", ".join([*source, *(f"{name}={row[name]}" for name in varied if name in row)])


def _span(name: str, values: Sequence[Any]) -> tuple[str, ...] | None:
    """Return lowest, median and highest of numbers, or the counts of yes and no."""
    known = [value for value in values if value is not None]
    if known and all(isinstance(value, bool) for value in known):
        return (name, str(len(known)), f"{sum(known)} yes", "", f"{len(known) - sum(known)} no")
    numbers = [value for value in known if isinstance(value, int | float)]
    if not numbers:
        return None
    ends = (min(numbers), float(np.median(numbers)), max(numbers))
    return (name, str(len(numbers)), *(f"{value:.4g}" for value in ends))


def counts(outcomes: Iterable[TaskOutcome]) -> Mapping[str, int]:
    """Return the numbers of completed and failed tasks."""
    states = Counter(outcome["state"] for outcome in outcomes)
    return {state: states[state] for state in ("done", "failed")}
