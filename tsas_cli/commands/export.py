"""`tsas export`: a model for other programs."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress


def export(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="A model file, or its folder.")],
    to: Annotated[str, typer.Option(metavar="FORMAT", help="json, csv or mujoco (MJCF).")],
    out: Annotated[Path, typer.Option(metavar="FILE", help="The file to write.")],
    sheath_length_mm: Annotated[
        float | None, typer.Option(help="Of a MuJoCo model; default: that of the recordings.")
    ] = None,
    total_bend_rad: Annotated[float | None, typer.Option(help="Likewise.")] = None,
    preload_n: Annotated[float | None, typer.Option("--preload-N", help="Likewise.")] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write a model as JSON, CSV, or a MuJoCo model; what that cannot hold is said."""
    with progress("export", quiet=quiet):
        result = tsas.export(
            model,
            to=to,
            out=out,
            sheath_length_mm=sheath_length_mm,
            total_bend_rad=total_bend_rad,
            preload_N=preload_n,
            force=force,
        )
    present(result, quiet=quiet, as_json=as_json)
