"""The simulate stage: every run of a dataset with one model, written beside its errors."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from tsas_cli.identification.comparison import Compared, compare
from tsas_cli.identification.long_runs import open_long, simulate_long
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.model_file import model_for, source_of, write_model
from tsas_cli.identification.own_values import with_own_values
from tsas_cli.identification.phases import segment, segment_records
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.physics.mesh import MOST_NODES
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import WrittenRuns, write_result
from tsas_cli.records import simulation as records
from tsas_cli.records.base import number_text
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, of_kind, path_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True, repr=False, eq=False)
class SimulationResult(Result):
    """What a model predicts of every run; `result["a"]` is run a.

    `runs` holds them by id: columns of shape (n,) as in the recording, `x_in_mm` as conditioned
    [mm], `f_in_N` and `f_out_N` [N], `x_out_mm` [mm]; NaN in gaps of the drive. Those that were
    written are read when they are asked for.
    """

    record: records.SimulationFile  # what `simulation.json` holds
    model: Model  # that was simulated
    runs: Mapping[str, Recording]

    def __getitem__(self, run: str) -> Recording:
        """Return a simulated run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return how far each channel of each run is from the measurement."""
        rows = [
            (
                run,
                name,
                number_text(c.rmse, ".4g"),
                number_text(c.noise, ".2g"),
                c.unit or "",
                found.solver,
            )
            for run, found in self.record.runs.items()
            for name, c in found.channels.items()
        ]
        header = ("run", "channel", "RMSE", "noise", "unit", "solver")
        return [(self.titled(f"{self.record.dynamics} model"), header, rows)]

    def sentences(self) -> Sequence[str]:
        """Return what of the simulation is not to be trusted, and why."""
        return notes(self.record.notes)


def simulate(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    dynamics: Literal["static", "slip", "lugre"] = "slip",
    fit_own: bool = False,
    nodes: int | None = None,
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
    each: Callable[[records.SimulationFile, Recording, Model], None] = lambda *_: None,
) -> SimulationResult:
    """Simulate every run with a model and say how far it is from the measurement.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `runs/ID.parquet` and `simulation.json`; None writes nothing.
    model
        A model, or its file; the data sheet's without it.
    dynamics
        `static`: the paper's lumped model; `slip`: the distributed one; `lugre`: the dynamic one.
    fit_own
        Fit what belongs to each run alone first: its preload and its zeros.
    nodes
        Nodes of the chain, 2 to 1000; the usual number without it.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Called once for each run.
    each
        Called after each run with the summary so far, the simulated run, and the model as used.

    Returns
    -------
    SimulationResult
        `result["a"].columns` holds the simulation of run a, arrays of shape (n,) as its recording:
        `time_s`, `x_in_mm` as conditioned, `f_in_N`, `f_out_N`, `x_out_mm`; NaN where nothing is
        simulated. `.summary["runs"]["a"]["channels"]` holds RMSE and noise of each channel, in
        its unit.

    Raises
    ------
    InputError
        The model, a recording or the number of nodes is wrong, or `out` exists and `force` is not
        set.
    """
    data, known, path = dataset_of(dataset, runs), path_of(model, Model), path_of(out)
    _refuse_nodes(nodes, dynamics)
    taken = data_sheet(data.manifest) if known is None else model_for(known, data.manifest.run)
    session_start = taken.session_start(data.manifest)
    record = records.SimulationFile(
        **data.header(path),
        model=source_of(known, path),
        dynamics=dynamics,
        nodes=nodes,
        own_values_fitted=bool(fit_own),
        runs={},
    )
    kept, used = dict[str, Recording](), taken
    with folder_if(path, stage="simulate", inputs=[data.folder, known], force=force) as folder:
        if folder is not None:
            (folder / "runs").mkdir()
        step.ahead(len(data.runs))
        for entry in data.runs:
            predicted, long = None, open_long(data, entry, session_start)
            if long is not None:
                own = with_own_values(taken, long.prepared()) if fit_own else taken
                summary, run = simulate_long(long, own, dynamics, nodes, folder and folder / "runs")
            else:
                run = prepare(data[entry.id], session_start)
                own = with_own_values(taken, run) if fit_own else taken
                compared = compare(run, own, dynamics, nodes)
                summary, predicted = compared.summary, _prediction(run, compared)
            used = Model(tuple(e for e in own.estimates if e.run == entry.id)).over(used)
            record = record.with_run(
                entry.id, summary.record(run), segment_records(run, segment(run))
            )
            if predicted is not None:  # not written piece by piece
                if folder is None:
                    kept[entry.id] = predicted
                else:  # many runs need no more memory than one
                    write_result(folder / "runs", predicted)
                each(record, predicted, used)
            step()
        record = record.model_copy(update={"notes": _notes(record.runs)})
        if folder is not None:
            record.write(folder)
            # What the model was fitted to, its own file says; these recordings are only followed.
            write_model(folder / MODEL_FILE, used, version=record.version, dataset={})
    written = path and WrittenRuns(path / "runs", {run.id: run for run in data.runs})
    return SimulationResult(record.content(), path, record, taken, written or kept)


def _refuse_nodes(nodes: int | None, dynamics: Dynamics) -> None:
    if nodes is None:
        return
    if dynamics == "static":
        raise InputError(
            "the static model has no nodes", where="--nodes", remedy="use --dynamics slip or lugre"
        )
    if not 2 <= of_kind((int,), nodes) <= MOST_NODES:
        raise InputError(f"{nodes} nodes", where="--nodes", expected=f"2 to {MOST_NODES}")


def _prediction(run: Prepared, compared: Compared) -> Recording:
    """Return time, x_in as conditioned, and what the model predicts of a run."""
    columns = {"time_s": run.time_s, "x_in_mm": compared.response.x_in_mm, **compared.channels}
    return Recording(run.run, {name: values.astype(float) for name, values in columns.items()})


def _notes(runs: Mapping[str, records.SimulatedRun]) -> tuple[str, ...]:
    """Return the runs' notes, each once, with the runs that it is of."""
    of: dict[str, list[str]] = {}
    for run_id, compared in runs.items():
        for note in compared.notes:
            of.setdefault(note, []).append(run_id)
    return tuple(
        note if len(ids) == len(runs) else f"run {', '.join(ids)}: {note}"
        for note, ids in of.items()
    )
