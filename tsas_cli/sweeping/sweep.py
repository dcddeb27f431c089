"""Run the pending tasks of a sweep, and write the results of all."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from tsas_cli.records.result import Result, Table
from tsas_cli.support import __version__
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
from tsas_cli.sweeping.outcome import Row, TaskOutcome
from tsas_cli.sweeping.plan import SweepPlan
from tsas_cli.sweeping.tables import counts, parameter_rows, printed, rows_of, write_rows
from tsas_cli.sweeping.tasks import Task
from tsas_cli.sweeping.versions import versions

if TYPE_CHECKING:
    import pandas as pd

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
    rows = rows_of(tasks, outcomes)
    summary = {
        "format": 1,
        "stage": "sweep",
        "version": __version__,
        "versions": versions(),
        "plan": plan.model_dump(mode="json", by_alias=True, exclude_defaults=True),
        "varied": list(dict.fromkeys(name for task in tasks for name in task.point)),
        "counts": counts(outcomes),
        "tasks": rows,
    }
    found = parameter_rows(tasks, outcomes)
    tables = {TABLE: partial(write_rows, rows=rows)}
    tables |= {PARAMETERS: partial(write_rows, rows=found)} if found else {}
    if not found:
        (out / PARAMETERS).unlink(missing_ok=True)  # of an earlier plan
    for name, write in {**tables, SUMMARY: partial(write_json, content=summary)}.items():
        with own_file(out / name) as path:
            write(path)
    seal(out)
    return summary
