"""A stage over many datasets or values, on many processes or a cluster."""

import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.stages.given import Named, at_least, file_of
from tsas_cli.stages.swept import WORK, options_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.sweeping.cluster import on_cluster
from tsas_cli.sweeping.folder import JOURNAL
from tsas_cli.sweeping.local import in_processes
from tsas_cli.sweeping.plan import read_plan
from tsas_cli.sweeping.sweep import SweepResult, sweep_tasks
from tsas_cli.sweeping.tasks import tasks_of


def sweep(
    plan: Mapping[str, Any] | Named,
    *,
    out: Named,
    workers: int | None = None,
    cluster: str | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> SweepResult:
    """Call a stage for many datasets or values, several at a time, and gather the results.

    Parameters
    ----------
    plan
        What is called for what: a file, or its content (docs/sweep.md).
    out
        The folder to write: `tasks/NAME/` for each call, `sweep.parquet` with a row for each,
        `parameters.parquet` with every parameter that was found, `sweep.json`. What an earlier
        sweep has finished there, from the same inputs and versions, is not done again.
    workers
        How many processes; one for each core without it.
    cluster
        The address of a Dask scheduler whose workers are taken instead.
    force
        Do those again that are done.
    step
        Called for each task.

    Returns
    -------
    SweepResult
        `.frame()` is the table as pandas has it, `.failed` says which tasks failed and why;
        `.summary` is what `sweep.json` holds.

    Raises
    ------
    InputError
        The plan or what it names is wrong, the cluster cannot do it, or `out` holds something else
        than an earlier sweep. A task that fails raises nothing: it is in the table.
    """
    if workers is not None and cluster is not None:
        raise InputError(
            "workers are those of the cluster", where="--workers", remedy="leave out one of the two"
        )
    given = plan if isinstance(plan, Mapping) else file_of(plan)
    read, base = read_plan(given)
    tasks, folder = tasks_of(read, base, options_of(read.stage)), file_of(out)
    if cluster is None:
        many = (os.cpu_count() or 1) if workers is None else at_least(1, workers, "workers")
        pool = partial(in_processes, WORK, workers=many)
    else:
        pool = partial(on_cluster, WORK, address=cluster, shared=(folder / JOURNAL).resolve())
    inputs = [given] if isinstance(given, Path) else []
    return sweep_tasks(read, tasks, folder, pool, inputs=inputs, force=force, step=step)
