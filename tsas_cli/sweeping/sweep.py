"""Run the pending tasks of a sweep, and write the results of all."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.records.result import Result, Table, heading
from tsas_cli.support.files import own_file, write_json
from tsas_cli.support.steps import Steps
from tsas_cli.sweeping.folder import (
    PARAMETERS,
    SUMMARY,
    TABLE,
    note,
    seal,
    sweep_folder,
    what_is_done,
)
from tsas_cli.sweeping.outcome import Row, TaskOutcome, versions
from tsas_cli.sweeping.plan import SweepPlan
from tsas_cli.sweeping.tasks import Task

if TYPE_CHECKING:
    import pandas as pd

MOST_SHOWN = 20  # failed tasks in the printed table; the file holds all
ENDS = ("_low", "_high", "_sd")  # of figures that are in the file only
_OF = {"run": "of_run"}  # of a parameter, in its table
COUNTED = ("verdict", "causes", "codes")  # results that are words, whose frequencies are printed
Pool = Callable[[Sequence[str]], Iterator[tuple[int, TaskOutcome]]]


@dataclass(frozen=True, repr=False, eq=False)
class SweepResult(Result):
    """The results of all tasks."""

    before: int  # number of tasks that an earlier call completed
    defects: int  # number of tasks that failed by a defect of the program, not by their input

    def frame(self) -> "pd.DataFrame":
        """Return the table as a pandas DataFrame: one row per task, with its state and results."""
        import pandas as pd

        return pd.DataFrame(self.summary["tasks"])

    @property
    def failed(self) -> dict[str, str]:
        """The reasons of the failed tasks, by name."""
        rows = self.summary["tasks"]
        return {row["task"]: row["error"] for row in rows if row["state"] == "failed"}

    def tables(self) -> list[Table]:
        """Return the range of each result over the tasks, and the failed tasks."""
        plan, done = self.summary["plan"], self.summary["counts"]
        title = f"{plan['stage']}: {done['done']} of {sum(done.values())} tasks done"
        varied = self.summary["varied"]
        return printed(self.summary["tasks"], varied, f"{title} → {(self.out or Path()) / TABLE}")

    def sentences(self) -> list[str]:
        """Return the number of earlier tasks, and the remedy for failed ones."""
        sentences = [f"{self.before} of them were completed before."] if self.before else []
        if self.failed:
            sentences.append("Repeat the call to run the failed tasks again; the others are kept.")
        return sentences


def sweep_tasks(
    plan: SweepPlan,
    tasks: Sequence[Task],
    out: Path,
    pool: Pool,
    *,
    inputs: Iterable[Path],
    force: bool,
    step: Steps,
) -> SweepResult:
    """Return the results of all tasks, after running the pending ones, or all with `force`.

    `out` is a new folder, or that of an earlier sweep. The pool runs tasks, and yields their number
    and outcome. `inputs` are files besides those of the tasks.

    InputError: the folder cannot be used or holds an input, or the pool fails.
    """
    inputs = [*inputs, *{Path(path) for task in tasks for path in task.places.values()}]
    with sweep_folder(out, inputs) as folder:
        done = {} if force else {n: what_is_done(folder, task.key) for n, task in enumerate(tasks)}
        outcomes = {number: outcome for number, outcome in done.items() if outcome is not None}
        before, pending = len(outcomes), [n for n in range(len(tasks)) if n not in outcomes]
        step.ahead(len(pending))
        if pending:
            texts = [tasks[number].text(folder, force=force) for number in pending]
            with closing(pool(texts)) as completed:  # type: ignore[type-var] # a generator
                for index, outcome in completed:
                    outcomes[pending[index]] = outcome
                    note(out, tasks[pending[index]], outcome)
                    step()
        ordered = [outcomes[number] for number in range(len(tasks))]
        return SweepResult(
            _written(out, plan, tasks, ordered),
            out,
            before,
            sum(outcome.get("defect", False) for outcome in ordered),
        )


def _written(
    out: Path, plan: SweepPlan, tasks: Sequence[Task], outcomes: Sequence[TaskOutcome]
) -> Row:
    """Return the summary, after writing the tables and the summary itself."""
    both = list(zip(tasks, outcomes, strict=True))
    rows = [
        {
            **_named(task),
            **({"run": task.source.run} if task.source and task.source.run else {}),
            **task.point,
            "state": outcome["state"],
            "error": outcome.get("error"),
            **outcome.get("results", {}),
        }
        for task, outcome in both
    ]
    found = [
        {**_named(task), **task.point, **{_OF.get(key, key): v for key, v in parameter.items()}}
        for task, outcome in both
        for parameter in outcome.get("parameters", [])
    ]
    states = Counter(outcome["state"] for outcome in outcomes)
    summary = heading("sweep") | {
        "versions": versions(),
        "plan": plan.model_dump(mode="json", by_alias=True, exclude_defaults=True),
        "varied": list(dict.fromkeys(name for task in tasks for name in task.point)),
        "counts": {state: states[state] for state in ("done", "failed")},
        "tasks": rows,
    }
    for name, table in ((TABLE, rows), (PARAMETERS, found)):
        if table:
            with own_file(out / name) as path:
                write_rows(path, table)
        else:
            (out / name).unlink(missing_ok=True)  # of an earlier plan
    with own_file(out / SUMMARY) as path:
        write_json(path, summary)
    seal(out)
    return summary


def _named(task: Task) -> Row:
    return {"task": task.key} | ({"dataset": task.source.name} if task.source else {})


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as Parquet; a column of mixed types is text."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {}
    for name in names:
        values = [row.get(name) for row in rows]
        try:
            columns[name] = pa.array(values)
        except (pa.ArrowInvalid, pa.ArrowTypeError):
            columns[name] = pa.array([None if value is None else str(value) for value in values])
    pq.write_table(pa.table(columns), path, compression="zstd")


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
        shown = []
        for row in failed[:MOST_SHOWN]:  # by the dataset, run and values that identify the task
            source = [str(row[name]) for name in ("dataset", "run") if name in row]
            values = [f"{name}={row[name]}" for name in varied if name in row]
            shown.append((", ".join([*source, *values]), row["error"]))
        tables.append((f"failed {len(failed)}{more}", ("input", "error"), shown))
    return tables


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
