"""`tsas ingest`: from a person's files to a dataset."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, OutFolder, Quiet, present
from tsas_cli.commands.progress import progress


def ingest(
    sources: Annotated[
        list[Path], typer.Argument(metavar="SOURCE", help="Files, or folders to search.")
    ],
    map_path: Annotated[Path, typer.Option("--map", metavar="MAP.toml", help="What they hold.")],
    out: OutFolder,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Turn files of a rig into a dataset, as a map says (docs/ingest.md shows one)."""
    with progress("ingest", quiet=quiet) as step:
        result = tsas.ingest(sources, map=map_path, out=out, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
