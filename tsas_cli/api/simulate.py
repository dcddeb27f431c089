"""Run a model on the recorded inputs."""

from collections.abc import Callable, Iterable
from typing import Any, Literal

from tsas_cli.api.given import Named, dataset_of, one_of, path_of
from tsas_cli.identification.model import Model
from tsas_cli.identification.simulation import SimulationResult, simulate_dataset
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.steps import SILENT, Steps

DYNAMICS: tuple[Literal["static", "slip", "lugre"], ...] = ("static", "slip", "lugre")


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
    step: Steps = SILENT,
    each: Callable[[dict[str, Any], Recording, Model], None] = lambda *_: None,
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
        Told of a piece of work per run.
    each
        Called after each run with the summary so far, the answer to it, and the model as used.

    Returns
    -------
    SimulationResult
        `result["a"].columns` holds the answer to run a, arrays of shape (n,) as in the recording:
        `time_s`, `x_in_mm` as conditioned, `f_in_N`, `f_out_N`, `x_out_mm`; NaN where nothing is
        simulated. `.summary["runs"]["a"]["channels"]` holds RMSE and noise of each channel, in
        its unit.

    Raises
    ------
    InputError
        The model, a recording or the number of nodes is wrong, or `out` exists and `force` is not
        set.
    """
    return simulate_dataset(
        dataset_of(dataset, runs),
        path_of(model),
        one_of(DYNAMICS, dynamics, "dynamics"),
        path_of(out),
        fit_own=fit_own,
        nodes=nodes,
        force=force,
        step=step,
        each=each,
    )
