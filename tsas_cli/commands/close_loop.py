"""`tsas close-loop`: hide an effect in a rig, diagnose it, and track with the better model."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, names, present
from tsas_cli.commands.progress import progress


def close_loop(
    out: OutFolder,
    cases: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Only these cases, with commas between; else all."),
    ] = None,
    hide: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Hide this in place of the known cases."),
    ] = None,
    settings: Annotated[
        Path | None,
        typer.Option(metavar="S.toml", help="Rig, drive, sensors, reference and gains."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="How many seeds of noise.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="The first of them.")] = 1,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say what a diagnosis is worth in tracking: nominal, extended and true model side by side."""
    with progress("close-loop", quiet=quiet) as step:
        result = tsas.close_loop(
            out=out,
            cases=names(cases),
            hide=hide or (),
            settings=settings,
            seeds=seeds,
            first_seed=seed,
            force=force,
            step=step,
        )
    present(result, quiet=quiet, as_json=as_json)
