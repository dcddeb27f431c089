"""`tsas plan`: the detectable effects of planned or recorded runs, and the best further run."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress


def plan(
    path: Annotated[
        str, typer.Argument(metavar="DATASET|RIG.toml", help="A dataset, or planned runs.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/plan.json.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Compute the smallest detectable size of each effect, and the most useful further run."""
    with progress("plan", quiet=quiet) as step:
        result = tsas.plan(path, out=out, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
