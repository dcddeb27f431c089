"""`tsas check`: check recordings for faults."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands import common
from tsas_cli.support.errors import InputError


def check(
    dataset: common.DatasetFolder,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/check.json.")
    ] = None,
    runs: common.ChosenRuns = None,
    rrd: common.Rrd = False,
    force: common.Force = False,
    quiet: common.Quiet = False,
    as_json: common.Json = False,
) -> None:
    """Check recordings for faults before a model is fitted."""
    if rrd and out is None:
        raise InputError("--rrd has no folder to write to", remedy="set --out")
    with common.progress("check", quiet=quiet) as step, common.with_stream(rrd, step):
        result = tsas.check(dataset, out=out, runs=common.names(runs), force=force, step=step)
    common.present(result, quiet=quiet, as_json=as_json)
