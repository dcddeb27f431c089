"""Fit the nominal model to recordings."""

from collections.abc import Iterable
from typing import Literal

from tsas_cli.api.given import Named, dataset_of, one_of, path_of
from tsas_cli.identification.calibrate_stage import CalibrationResult, calibrate_dataset
from tsas_cli.identification.model import Model
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.steps import SILENT, Steps

DYNAMICS: tuple[Literal["slip", "lugre"], ...] = ("slip", "lugre")


def calibrate(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    dynamics: Literal["slip", "lugre"] = "slip",
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = SILENT,
) -> CalibrationResult:
    """Fit the nominal model to a dataset, and the stiffness km of each phase.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `model.toml` and `calibration.json`; None writes nothing.
    model
        A model to begin with, or its file, whose effects stay; the data sheet's without it.
    dynamics
        `slip`: the distributed model; `lugre`: the dynamic one, with bristles and speed.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Told of two pieces of work per run.

    Returns
    -------
    CalibrationResult
        `.model` holds every parameter with unit and 95 % interval; `.calibration` what was found
        on the way, run by run: `segments` (phases), `slopes` (km [N/mm]), `answers` (simulated
        channels, shape (n,)); `.summary` is what `calibration.json` holds.

    Raises
    ------
    InputError
        A recording or the model is wrong, a channel has the wrong sign, or `out` exists and
        `force` is not set.
    """
    return calibrate_dataset(
        dataset_of(dataset, runs),
        path_of(out),
        one_of(DYNAMICS, dynamics, "dynamics"),
        path_of(model),
        force=force,
        step=step,
    )
