"""`tsas calibrate`: phases, stiffness per phase, and the joint fit of the nominal model."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands import common


def calibrate(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="The initial model, whose effects are kept."),
    ] = None,
    dynamics: Annotated[
        Literal["slip", "lugre"],
        typer.Option("--dynamics", help="slip: distributed friction; lugre: dynamic friction."),
    ] = "slip",
    runs: common.ChosenRuns = None,
    despite: common.Despite = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Fit the nominal model and the stiffness km of each phase to a dataset."""
    with common.progress("calibrate", quiet=quiet) as step, common.with_stream(rrd, step):
        result = tsas.calibrate(
            dataset,
            out=out,
            model=model,
            dynamics=dynamics,
            runs=common.names(runs),
            despite=despite or (),
            force=force,
            step=step,
        )
    common.present(result, quiet=quiet, as_json=as_json)
