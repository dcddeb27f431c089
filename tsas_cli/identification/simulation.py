"""The simulate stage: every run of a dataset with one model, written beside its errors."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from tsas_cli import __version__
from tsas_cli.errors import InputError
from tsas_cli.files import new_folder, write_json
from tsas_cli.identification.base_fit import with_own_values
from tsas_cli.identification.comparison import Compared, compare
from tsas_cli.identification.model import (
    FILE,
    Model,
    data_sheet,
    read_model,
    source_of,
    write_model,
)
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.physics.chain_state import MOST_NODES
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.dataset import Dataset, write_parquet


def simulate_dataset(
    dataset: Dataset,
    model_path: Path | None,
    dynamics: Dynamics,
    out: Path,
    *,
    fit_own: bool = False,
    nodes: int | None = None,
    force: bool = False,
    step: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Simulate all runs and write answers, errors and the model as used into a new folder.

    Without a model file the manifest's data sheet is simulated. With `fit_own` the preload and the
    zeros of each run are fitted first, all else stays as the model says: so a model predicts runs
    that it was not fitted to. `nodes` asks for a chain with as many of them. `step` is called after
    each run.

    Raises
    ------
    InputError
        The model, a recording or the number of nodes is wrong, or `out` exists and `force` is not
        set.
    """
    _refuse_nodes(nodes, dynamics)
    model = data_sheet(dataset.manifest) if model_path is None else read_model(model_path)
    summary = dataset.header("simulate", out) | {"model": source_of(model_path)}
    summary |= {"dynamics": dynamics, "nodes": nodes, "own_values_fitted": fit_own, "runs": {}}
    summary["segments"] = {}
    used = model
    with new_folder(out, force=force) as folder:
        (folder / "runs").mkdir()
        for recording in dataset:
            run = prepare(recording, dataset.manifest.session_start)
            own = with_own_values(model, run) if fit_own else model
            used = _of_run(own, run.run.id).over(used)
            answer = compare(run, own, dynamics, nodes)
            write_parquet(folder / "runs" / f"{run.run.id}.parquet", _table(run, answer))
            summary["runs"][run.run.id] = answer.as_json(run)
            summary["segments"][run.run.id] = segments_as_json(run, segment(run))
            step()
        summary["notes"] = _notes(summary["runs"])
        write_json(folder / "simulation.json", summary)
        write_model(folder / FILE, used, version=__version__, dataset=summary["dataset"])
    return summary


def _of_run(model: Model, run: str) -> Model:
    """Return what of a model belongs to a run alone."""
    return Model(tuple(e for e in model.estimates if e.run == run))


def _refuse_nodes(nodes: int | None, dynamics: Dynamics) -> None:
    if nodes is None:
        return
    if dynamics == "static":
        raise InputError(
            "the static model has no nodes", where="--nodes", remedy="use --dynamics slip or lugre"
        )
    if not 2 <= nodes <= MOST_NODES:
        raise InputError(f"{nodes} nodes", where="--nodes", expected=f"2 to {MOST_NODES}")


def _notes(runs: dict[str, Any]) -> list[str]:
    """Return the runs' notes, each once, with the runs that it is of."""
    of: dict[str, list[str]] = {}
    for run_id, answer in runs.items():
        for note in answer["notes"]:
            of.setdefault(note, []).append(run_id)
    return [
        note if len(ids) == len(runs) else f"run {', '.join(ids)}: {note}"
        for note, ids in of.items()
    ]


def _table(run: Prepared, answer: Compared) -> pa.Table:
    """Return time, the conditioned or simulated x_in, and the answers; NaN as null."""
    columns = {"time_s": run.time_s, "x_in_mm": answer.response.x_in_mm, **answer.channels}
    return pa.table(
        {name: pa.array(v.astype(np.float64), from_pandas=True) for name, v in columns.items()}
    )
