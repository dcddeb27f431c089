"""A stage over many datasets or values, on many processes or a cluster."""

import os
import socket
import time
from collections.abc import Mapping
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, get_type_hints

from pydantic import TypeAdapter

import tsas_cli as tsas
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.model_file import model_for, model_of
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.stages.given import Named, at_least, file_of
from tsas_cli.stages.read import read
from tsas_cli.support.errors import NO_MEMORY, InputError
from tsas_cli.support.files import Raw, new_folder, read_json, sha256_of, write_json, write_sums
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.temporaries import remove
from tsas_cli.sweeping.cluster import on_cluster
from tsas_cli.sweeping.folder import JOURNAL, what_is_done
from tsas_cli.sweeping.key_figures import estimates, figures
from tsas_cli.sweeping.local import in_processes
from tsas_cli.sweeping.outcome import (
    ONE_THREAD,
    TaskOutcome,
    failure,
    refuse_others,
    success,
    versions,
)
from tsas_cli.sweeping.plan import read_plan
from tsas_cli.sweeping.sweep import SweepResult, sweep_tasks
from tsas_cli.sweeping.tasks import TASK_FILE, tasks_of
from tsas_cli.sweeping.values import FILES, Options, with_settings

WORK = f"{__name__}:work"
OF_A_SWEEP = {"dataset", "out", "force", "step", "each"}  # not for a plan to say
TRACKED = "track"  # the run of the closed loop's data sheet


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


def options_of(stage: str) -> Options:
    """Return the keywords of a stage's function that a plan may set, and what each may be."""
    hints = get_type_hints(getattr(tsas, stage)) | {"runs": list[str] | None}
    return {
        name: TypeAdapter(Any if name in FILES else hints[name])
        for name in signature(getattr(tsas, stage)).parameters
        if name not in OF_A_SWEEP
    }


def work(task: Raw) -> TaskOutcome:
    """Do a task; what goes wrong is its outcome."""
    os.environ.update(ONE_THREAD)  # this process does one task at a time
    start, before = time.perf_counter(), time.process_time()
    try:
        refuse_others(task["inputs"]["versions"], versions(), "this worker")
        outcome = _done(task)
    except InputError as error:
        # Files as the plan names them, so that the line is the same in every place.
        line, named = error.line(), {n: f["file"] for n, f in task["inputs"]["files"].items()}
        if "dataset" in task["inputs"]:
            named["dataset"] = task["inputs"]["dataset"]["name"]
        for name, said in named.items():
            line = line.replace(task["places"][name], said)
        outcome = failure(line, defect=False)
    except MemoryError:
        outcome = failure(NO_MEMORY, defect=False)
    except Exception as error:  # noqa: BLE001 # the other tasks go on; this one says what it was
        outcome = failure(f"a defect of tsas itself: {type(error).__name__}: {error}")
    return outcome | {
        "where": f"{socket.gethostname()}, process {os.getpid()}",
        "seconds": time.perf_counter() - start,
        "processor_seconds": time.process_time() - before,
    }


def _done(task: Raw) -> TaskOutcome:
    """Call the stage, and write its folder with its options and results."""
    inputs, places, key = task["inputs"], task["places"], task["key"]
    out = Path(places["out"])
    if not (out.parent / JOURNAL).is_file():
        raise InputError("is not there", where=out.parent, expected="the folder of the sweep")
    stage = inputs["stage"]
    found = what_is_done(out, key)
    if found is not None and not task["force"]:  # a worker died between this and its outcome
        return found
    if found is None:
        remove(out / key)  # half a result
    # with force, since another worker may be doing it too
    with new_folder(out / key, stage="sweep", inputs=(), force=True) as folder:
        result = getattr(tsas, stage)(**_arguments(inputs, places), out=folder)
        content = {"format": 1, "stage": "sweep", "key": key, "inputs": inputs}
        content |= {"results": figures(stage, result), "parameters": estimates(stage, result)}
        write_json(folder / TASK_FILE, content)
        write_sums(folder)  # of the stage, now with this file
        written: Raw = read_json(folder / TASK_FILE)  # as a later call will find it
    return success(written["results"], written["parameters"])


def _arguments(inputs: Raw, places: Raw) -> Raw:
    given: Raw = inputs["options"] | {name: Path(places[name]) for name in inputs["files"]}
    for name, source in inputs["files"].items():
        _refuse_changed(Path(places[name]), source["sha256"])
    if "dataset" in inputs:
        folder = Path(places["dataset"])
        _refuse_changed(folder / MANIFEST_FILE, inputs["dataset"]["sha256"])
        given["dataset"] = dataset = read(folder).under(**inputs["conditions"])
        if inputs["model"]:
            base = data_sheet(dataset.manifest)
            if "model" in given:
                base = model_for(given["model"], dataset.manifest.run)
            runs = [run.id for run in dataset.runs]
            given["model"] = _with_values(inputs["model"], runs, base)
        return given
    if inputs["model"]:
        given["model"] = _with_values(inputs["model"], [TRACKED], given.get("model"))
    if inputs["plant"]:
        given["plant"] = _with_values(
            inputs["plant"], [TRACKED], given.get("plant", given.get("model"))
        )
    if inputs["settings"]:
        given["settings"] = with_settings(given.get("settings"), inputs["settings"])
    return given


def _with_values(values: Raw, runs: list[str], base: Model | Path | None) -> Model:
    """Return a model with some values replaced; what has a value for each run has it for all."""
    given_values: list[Estimate] = []
    for name, value in values.items():
        quantity = QUANTITIES[name]
        of = [None] if quantity.shared else [None, *runs]
        given_values += [Estimate(name, value, quantity.unit, "given", run) for run in of]
    known = Model(()) if base is None else model_of(base)
    return Model(tuple(given_values)).over(known)


def _refuse_changed(path: Path, sha256: str) -> None:
    """Stop where a file is another one than when the sweep was begun, or where the worker is."""
    if not path.is_file():
        raise InputError("is not there", where=path, expected="a file that every worker sees")
    if sha256_of(path) != sha256:
        raise InputError(
            "is another file than when the sweep was begun", where=path, remedy="sweep again"
        )
