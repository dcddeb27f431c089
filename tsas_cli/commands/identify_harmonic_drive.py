"""`tsas identify-harmonic-drive`: G(s) from motor speed to x_in, its inverse, its residuals."""

from typing import Annotated, Literal

import typer

import tsas_cli as tsas
from tsas_cli.commands import common


def identify_harmonic_drive(
    dataset: common.DatasetFolder,
    out: common.OutFolder,
    speed: Annotated[
        Literal["measured", "commanded"],
        typer.Option(
            "--speed",
            help="measured: linear between samples; commanded: zero-order hold, as from a "
            "controller. The wrong choice is a delay of half a sample.",
        ),
    ] = "measured",
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Identify the drive from motor speed to x_in, diagnose it, and compute its feedforward."""
    with common.progress("identify", quiet=quiet) as step, common.with_stream(rrd, step):
        result = tsas.identify_harmonic_drive(
            dataset, out=out, speed=speed, runs=common.names(runs), force=force, step=step
        )
    common.present(result, quiet=quiet, as_json=as_json)
