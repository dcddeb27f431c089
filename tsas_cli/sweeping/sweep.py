"""Do the tasks of a sweep that are not done yet, and write what came out of all."""

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
from tsas_cli.sweeping.answer import Answer, Row
from tsas_cli.sweeping.folder import (
    PARAMETERS,
    SUMMARY,
    TABLE,
    note,
    sweep_folder,
    what_is_done,
)
from tsas_cli.sweeping.plan import Plan
from tsas_cli.sweeping.tables import counts, parameter_rows, printed, rows_of, write_rows
from tsas_cli.sweeping.tasks import Task
from tsas_cli.sweeping.versions import versions

if TYPE_CHECKING:
    import pandas as pd

Pool = Callable[[Sequence[str]], Iterator[tuple[int, Answer]]]


@dataclass(frozen=True, repr=False, eq=False)
class SweepResult(Result):
    """What came out of all tasks.

    Parameters
    ----------
    before
        How many tasks an earlier call had finished.
    defects
        How many failed by a defect of the program, and not by their input.
    """

    before: int
    defects: int

    def frame(self) -> "pd.DataFrame":
        """Return the table as pandas has it: one row a task, its input, state and results."""
        import pandas as pd

        return pd.DataFrame(self.summary["tasks"])

    @property
    def failed(self) -> dict[str, str]:
        """The tasks that failed, by name, each with the reason."""
        rows = self.summary["tasks"]
        return {row["task"]: row["error"] for row in rows if row["state"] == "failed"}

    def tables(self) -> list[Table]:
        """Return the range of each result over the tasks, and those that failed."""
        plan, done = self.summary["plan"], self.summary["counts"]
        told = f"{plan['stage']}: {done['done']} of {sum(done.values())} tasks done"
        varied = self.summary["varied"]
        return printed(self.summary["tasks"], varied, f"{told} → {(self.out or Path()) / TABLE}")

    def sentences(self) -> list[str]:
        """Return what was there before, and what to do about failed tasks."""
        said = [f"{self.before} of them were done before."] if self.before else []
        if self.failed:
            said.append("Failed tasks are tried again by the same call; the others are not.")
        return said


def sweep_tasks(
    plan: Plan,
    tasks: Sequence[Task],
    out: Path,
    pool: Pool,
    *,
    inputs: Iterable[Path],
    force: bool,
    step: Steps,
) -> SweepResult:
    """Do the tasks that are not done, and write the tables of all.

    Parameters
    ----------
    plan
        What the tasks are from.
    tasks
        All of them.
    out
        The folder, a new one or that of an earlier sweep.
    pool
        Who does tasks.
    inputs
        What is read beside what the tasks name.
    force
        Do those again that are done.
    step
        Called after each.

    Raises
    ------
    InputError
        The folder cannot be used or holds an input, or the pool cannot work.
    """
    inputs = [*inputs, *{Path(place) for task in tasks for place in task.places.values()}]
    with sweep_folder(out, inputs) as folder:
        done = {} if force else {n: what_is_done(folder, task.key) for n, task in enumerate(tasks)}
        answers = {number: answer for number, answer in done.items() if answer is not None}
        before, left = len(answers), [n for n in range(len(tasks)) if n not in answers]
        step.ahead(len(left))
        if left:
            texts = [tasks[number].text(folder, force=force) for number in left]
            with closing(pool(texts)) as coming:  # type: ignore[type-var] # a generator
                for place, answer in coming:
                    answers[left[place]] = answer
                    note(out, tasks[left[place]], answer)
                    step()
        ordered = [answers[number] for number in range(len(tasks))]
        return SweepResult(
            _written(out, plan, tasks, ordered),
            out,
            before,
            sum(answer.get("defect", False) for answer in ordered),
        )


def _written(out: Path, plan: Plan, tasks: Sequence[Task], answers: Sequence[Answer]) -> Row:
    """Write the tables, and the summary last; return the summary."""
    rows = rows_of(tasks, answers)
    summary = {
        "format": 1,
        "stage": "sweep",
        "version": __version__,
        "versions": versions(),
        "plan": plan.model_dump(mode="json", by_alias=True, exclude_defaults=True),
        "varied": list(dict.fromkeys(name for task in tasks for name in task.point)),
        "counts": counts(answers),
        "tasks": rows,
    }
    found = parameter_rows(tasks, answers)
    tables = {TABLE: partial(write_rows, rows=rows)}
    tables |= {PARAMETERS: partial(write_rows, rows=found)} if found else {}
    if not found:
        (out / PARAMETERS).unlink(missing_ok=True)  # of an earlier plan
    for name, write in {**tables, SUMMARY: partial(write_json, content=summary)}.items():
        with own_file(out / name) as path:
            write(path)
    return summary
