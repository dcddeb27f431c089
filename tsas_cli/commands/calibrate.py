"""`tsas calibrate`: phases, stiffness per phase, and the joint fit of the nominal model."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

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


class DynamicsOption(StrEnum):
    """The models of the tendon that can be calibrated."""

    slip = "slip"
    lugre = "lugre"


def calibrate(
    dataset: DatasetFolder,
    out: OutFolder,
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="A model to begin with, whose effects stay."),
    ] = None,
    dynamics: Annotated[
        DynamicsOption,
        typer.Option(
            "--dynamics", help="slip: distributed; lugre: dynamic, with bristles and speed."
        ),
    ] = DynamicsOption.slip,
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Fit the nominal model to a dataset, and the stiffness km of each phase."""
    from tsas_cli.identification.calibrate_stage import calibrate_dataset, tables

    data = opened(dataset, runs)
    with progress("calibrate", 2 * len(data.runs), quiet=quiet or as_json) as step:
        summary = calibrate_dataset(data, out, dynamics.value, model, force=force, step=step)
    if rrd:
        add_stream(out, quiet=quiet or as_json)
    show(summary, tables(summary, out), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["cannot_tell"]:
            print(f"- {sentence}")
