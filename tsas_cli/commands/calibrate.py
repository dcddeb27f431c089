"""`tsas calibrate`: phases, stiffness per phase, and the joint fit of the nominal model."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Despite,
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


def calibrate(
    dataset: DatasetFolder,
    out: OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="The initial model, whose effects are kept."),
    ] = None,
    dynamics: Annotated[
        Literal["slip", "lugre"],
        typer.Option("--dynamics", help="slip: distributed friction; lugre: dynamic friction."),
    ] = "slip",
    runs: ChosenRuns = None,
    despite: Despite = None,
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
            dynamics=dynamics,
            runs=names(runs),
            despite=despite or (),
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)
