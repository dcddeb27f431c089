"""`tsas check`: check recordings for faults."""

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
    Rrd,
    names,
    present,
    with_stream,
)
from tsas_cli.commands.progress import progress
from tsas_cli.support.errors import InputError


def check(
    dataset: DatasetFolder,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/check.json.")
    ] = None,
    runs: ChosenRuns = None,
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Check recordings for faults before a model is fitted."""
    if rrd and out is None:
        raise InputError("--rrd has no folder to write to", remedy="set --out")
    with progress("check", quiet=quiet) as step, with_stream(rrd, step):
        result = tsas.check(dataset, out=out, runs=names(runs), force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
