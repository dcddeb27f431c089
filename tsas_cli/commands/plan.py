"""`tsas plan`: what a set of runs could show, before anyone measures, and what to add to it."""

from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Force, Json, Quiet, progress, show


def plan(
    path: Annotated[
        Path, typer.Argument(metavar="DATASET|RIG.toml", help="A dataset, or planned runs.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Also write DIR/plan.json.")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say from which size on runs would show each effect, and which further run helps most."""
    from tsas_cli.diagnosis.plan_stage import STEPS, plan_path, tables

    with progress("plan", STEPS, quiet=quiet or as_json) as step:
        summary = plan_path(path, out, force=force, step=step)
    show(summary, tables(summary), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["cannot_tell"]:
            print(f"- {sentence}")
