"""Name what a model lacks."""

from collections.abc import Iterable

from tsas_cli.api.given import Named, dataset_of, path_of
from tsas_cli.diagnosis.diagnose_stage import DiagnosisResult, diagnose_dataset
from tsas_cli.identification.model import Model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.steps import SILENT, Steps


def diagnose(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = SILENT,
) -> DiagnosisResult:
    """Show what the simulation gets wrong, name the cause, extend the model, measure the gain.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `diagnosis.json` and `model-extended.toml`; None writes nothing.
    model
        A model to begin with, or its file; the data sheet's without it.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Told of every hypothesis; how many lie ahead grows with what is found.

    Returns
    -------
    DiagnosisResult
        `.verdict`, `.reason`, `.causes` (effect, rivals, parameters with 95 % intervals, gain on
        held-out data [%]), `.model` (the extended one), `.next_experiment`; `.summary` is what
        `diagnosis.json` holds, with the errors before and after, in each channel's unit.

    Raises
    ------
    InputError
        A recording or the model is wrong, or `out` exists and `force` is not set.
    """
    return diagnose_dataset(
        dataset_of(dataset, runs), path_of(model), path_of(out), force=force, step=step
    )
