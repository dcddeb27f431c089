"""`tsas identify-harmonic-drive`: from motor speed to x_in: G(s), its inverse, what it lacks."""

from enum import StrEnum
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


class SpeedOption(StrEnum):
    """What the column motor_speed_rpm holds."""

    measured = "measured"
    commanded = "commanded"


def identify_harmonic_drive(
    dataset: DatasetFolder,
    out: OutFolder,
    speed: Annotated[
        SpeedOption,
        typer.Option(
            "--speed",
            help="measured: linear between samples, as a turning motor's speed is; commanded: kept "
            "until the next sample, as a controller holds it. Taken wrongly it is half a sample "
            "of delay.",
        ),
    ] = SpeedOption.measured,
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Fit the drive from motor speed to x_in, diagnose it, and give its feedforward."""
    with progress("identify", quiet=quiet) as step, with_stream(rrd, step):
        result = tsas.identify_harmonic_drive(
            dataset, out=out, speed=speed.value, runs=names(runs), force=force, step=step
        )
    present(result, quiet=quiet, as_json=as_json)
