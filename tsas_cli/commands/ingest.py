"""`tsas ingest`: convert raw files to a dataset."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress
from tsas_cli.records.result import Result
from tsas_cli.support.errors import InputError


def ingest(
    sources: Annotated[
        list[Path], typer.Argument(metavar="SOURCE", help="Files, or folders to search.")
    ],
    map_path: Annotated[
        Path | None, typer.Option("--map", metavar="MAP.toml", help="The map of their columns.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="The folder to write; with --guess, the map to write."
        ),
    ] = None,
    guess: Annotated[
        bool, typer.Option("--guess", help="Propose a map, to standard output or --out.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Convert raw files to a dataset by a map, or propose the map (docs/ingest.md)."""
    result: Result
    if guess:
        if map_path is not None:
            raise InputError(
                "--guess proposes a map, --map uses one", remedy="leave one of them out"
            )
        result = tsas.guess(sources, out=out, force=force)
    elif map_path is None or out is None:
        source = shlex.quote(str(sources[0]))
        raise InputError(
            f"--{'out' if map_path else 'map'} is missing",
            expected="--map MAP.toml --out DATASET",
            remedy=f"`tsas ingest {source} --guess --out MAP.toml` proposes a map",
        )
    else:
        with progress("ingest", quiet=quiet) as step:
            result = tsas.ingest(sources, map=map_path, out=out, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
