"""`tsas check`: say what is wrong with recordings before anyone fits anything."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import (
    ChosenRuns,
    DatasetFolder,
    Force,
    Json,
    Quiet,
    names,
    present,
)
from tsas_cli.commands.progress import progress


def check(
    dataset: DatasetFolder,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/check.json.")
    ] = None,
    runs: ChosenRuns = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say what is wrong with recordings before anyone fits anything."""
    with progress("check", quiet=quiet) as step:
        result = tsas.check(dataset, out=out, runs=names(runs), force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
