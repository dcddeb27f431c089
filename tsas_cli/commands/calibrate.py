"""`tsas calibrate`: phases, stiffness per phase, and the joint fit of the nominal model."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    OutFolder,
    Quiet,
    Rrd,
    names,
    present,
    with_stream,
)
from tsas_cli.commands.progress import progress


class CalibrationDynamics(StrEnum):
    """The models of the tendon that can be calibrated."""

    slip = "slip"
    lugre = "lugre"


def calibrate(
    dataset: DatasetFolder,
    out: OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="The initial model, whose effects are kept."),
    ] = None,
    dynamics: Annotated[
        CalibrationDynamics,
        typer.Option("--dynamics", help="slip: distributed friction; lugre: dynamic friction."),
    ] = CalibrationDynamics.slip,
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Fit the nominal model and the stiffness km of each phase to a dataset."""
    with progress("calibrate", quiet=quiet) as step, with_stream(rrd, step):
        result = tsas.calibrate(
            dataset,
            out=out,
            model=model,
            dynamics=dynamics.value,
            runs=names(runs),
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)
