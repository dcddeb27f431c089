"""The simulate stage: every run of a dataset with one model, written beside its errors."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli import __version__
from tsas_cli.errors import InputError
from tsas_cli.files import folder_if, write_json
from tsas_cli.identification.base_fit import with_own_values
from tsas_cli.identification.comparison import Compared, compare
from tsas_cli.identification.long_runs import open_long
from tsas_cli.identification.long_simulation import simulate_long
from tsas_cli.identification.model import (
    FILE,
    Model,
    data_sheet,
    model_of,
    source_of,
    write_model,
)
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.physics.mesh import MOST_NODES
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_answer
from tsas_cli.recordings.written import WrittenRuns
from tsas_cli.result import Result, Table, notes
from tsas_cli.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class SimulationResult(Result):
    """Every run as a model answers it; `result["a"]` is run a.

    Parameters
    ----------
    model
        The model that was simulated.
    runs
        By id the answer to each run: columns of shape (n,) as in the recording, `x_in_mm` as
        conditioned [mm], `f_in_N` and `f_out_N` [N], `x_out_mm` [mm]; NaN in gaps of the drive.
        Those that were written are read when they are asked for.
    """

    model: Model
    runs: Mapping[str, Recording]

    def __getitem__(self, run: str) -> Recording:
        """Return the answer to a run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return how far each channel of each run is from the measurement."""
        rows = [
            (run, name, f"{c['rmse']:.4g}", f"{c['noise']:.2g}", c["unit"], answer["solver"])
            for run, answer in self.summary["runs"].items()
            for name, c in answer["channels"].items()
        ]
        header = ("run", "channel", "RMSE", "noise", "unit", "solver")
        return [(self.titled(f"{self.summary['dynamics']} model"), header, rows)]

    def sentences(self) -> Sequence[str]:
        """Return what of the simulation is not to be trusted, and why."""
        return notes(self.summary["notes"])


def simulate_dataset(
    dataset: Dataset,
    model: Model | Path | None,
    dynamics: Dynamics,
    out: Path | None,
    *,
    fit_own: bool = False,
    nodes: int | None = None,
    force: bool = False,
    step: Steps = SILENT,
    each: Callable[[dict[str, Any], Recording, Model], None] = lambda *_: None,
) -> SimulationResult:
    """Simulate all runs; write answers, errors and the model as used into a new folder if any.

    Without a model the manifest's data sheet is simulated. With `fit_own` the preload and the
    zeros of each run are fitted first, all else stays as the model says: so a model predicts runs
    that it was not fitted to. `nodes` asks for a chain with as many of them. After each run
    `step` is called, and `each` with the summary so far, the answer and the model; not after one
    that is too long for memory, whose answer is in its file alone.

    Raises
    ------
    InputError
        The model, a recording or the number of nodes is wrong, or `out` exists and `force` is not
        set.
    """
    _refuse_nodes(nodes, dynamics)
    taken = data_sheet(dataset.manifest) if model is None else model_of(model)
    summary = dataset.header("simulate", out) | {"model": source_of(model, out)}
    summary |= {"dynamics": dynamics, "nodes": nodes, "own_values_fitted": fit_own, "runs": {}}
    summary["segments"] = {}
    kept, used = dict[str, Recording](), taken
    with folder_if(out, force=force) as folder:
        if folder is not None:
            (folder / "runs").mkdir()
        step.ahead(len(dataset.runs))
        for entry in dataset.runs:
            long = open_long(dataset, entry)
            if long is not None:
                own = with_own_values(taken, long.prepared()) if fit_own else taken
                told, run = simulate_long(long, own, dynamics, nodes, folder and folder / "runs")
            else:
                run = prepare(dataset[entry.id], dataset.manifest.session_start)
                own = with_own_values(taken, run) if fit_own else taken
                answer = compare(run, own, dynamics, nodes)
                told = answer.told()
            used = _of_run(own, entry.id).over(used)
            summary["runs"][entry.id] = told.as_json(run)
            summary["segments"][entry.id] = segments_as_json(run, segment(run))
            if long is None:
                answered = Recording(entry, _columns(run, answer))
                if folder is None:
                    kept[entry.id] = answered
                else:  # many runs need no more memory than one
                    write_answer(folder / "runs", answered)
                each(summary, answered, used)
            step()
        summary["notes"] = _notes(summary["runs"])
        if folder is not None:
            write_json(folder / "simulation.json", summary)
            # What the model was fitted to, its own file says; these recordings are only followed.
            write_model(folder / FILE, used, version=__version__, dataset={})
    written = out and WrittenRuns(out / "runs", {run.id: run for run in dataset.runs})
    return SimulationResult(summary, out, taken, written or kept)


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


def _columns(run: Prepared, answer: Compared) -> dict[str, Floats]:
    """Return time, the conditioned or simulated x_in, and the answers."""
    columns = {"time_s": run.time_s, "x_in_mm": answer.response.x_in_mm, **answer.channels}
    return {name: values.astype(np.float64) for name, values in columns.items()}
