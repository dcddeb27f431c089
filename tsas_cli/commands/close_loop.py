"""`tsas close-loop`: hide an effect in a rig, diagnose it, and track with the better model."""

from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import (
    Force,
    Json,
    OutFolder,
    Quiet,
    Rrd,
    add_stream,
    progress,
    show,
)


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
    rrd: Rrd = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say what a diagnosis is worth in tracking: nominal, extended and true model side by side."""
    from tsas_cli.tracking.closing import STEPS
    from tsas_cli.tracking.closing_stage import chosen, close_all, tables
    from tsas_cli.tracking.settings import read_settings

    wanted = chosen(cases, hide or [])
    read = read_settings(settings)
    with progress("close-loop", STEPS * len(wanted), quiet=quiet or as_json) as step:
        summary = close_all(wanted, read, out, range(seed, seed + seeds), force=force, step=step)
    if rrd:
        for case in summary["cases"]:
            folder = out / case["case"]
            stages = (folder / name for name in ("dataset", "calibrate", "diagnose"))
            add_stream(folder, *stages, quiet=quiet or as_json)
    show(summary, tables(summary, out), quiet=quiet, as_json=as_json)
