"""`tsas identify-harmonic-drive`: from motor speed to x_in: G(s), its inverse, what it lacks."""

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    OutFolder,
    Quiet,
    Rrd,
    add_stream,
    opened,
    progress,
    show,
)

if TYPE_CHECKING:
    from tsas_cli.numerics.linear_response import Hold


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
    from tsas_cli.diagnosis.drive_stage import identify_drive
    from tsas_cli.diagnosis.drive_tables import tables

    data = opened(dataset, runs)
    with progress("identify", None, quiet=quiet or as_json) as step:
        hold: Hold = "first" if speed is SpeedOption.measured else "zero"
        summary = identify_drive(data, out, hold, force=force, step=step)
    if rrd:
        add_stream(out, quiet=quiet or as_json)
    show(summary, tables(summary, out), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        print(summary["diagnosis"]["reason"])
        print(summary["inverse"])
        print(f"Next: {summary['diagnosis']['next_experiment']}")
        for sentence in summary["cannot_tell"]:
            print(f"- {sentence}")
