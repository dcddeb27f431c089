"""`tsas identify-harmonic-drive`: G(s) from motor speed to x_in, its inverse, its residuals."""

from typing import Annotated, Literal

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


def identify_harmonic_drive(
    dataset: DatasetFolder,
    out: OutFolder,
    speed: Annotated[
        Literal["measured", "commanded"],
        typer.Option(
            "--speed",
            help="measured: linear between samples; commanded: zero-order hold, as from a "
            "controller. The wrong choice is a delay of half a sample.",
        ),
    ] = "measured",
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Identify the drive from motor speed to x_in, diagnose it, and compute its feedforward."""
    with progress("identify", quiet=quiet) as step, with_stream(rrd, step):
        result = tsas.identify_harmonic_drive(
            dataset, out=out, speed=speed, runs=names(runs), force=force, step=step
        )
    present(result, quiet=quiet, as_json=as_json)
