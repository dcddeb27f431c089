"""`tsas ingest`: from a person's files to a dataset."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, show
from tsas_cli.commands.progress import progress
from tsas_cli.errors import InputError


def ingest(
    sources: Annotated[
        list[Path], typer.Argument(metavar="SOURCE", help="Files, or folders to search.")
    ],
    map_path: Annotated[
        Path | None, typer.Option("--map", metavar="MAP.toml", help="What they hold.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="The folder to write; with --guess, the map."),
    ] = None,
    guess: Annotated[
        bool, typer.Option("--guess", help="Propose a map, on standard output or into --out.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Turn files of a rig into a dataset, as a map says; or propose the map (docs/ingest.md)."""
    if guess:
        _guess(sources, map_path, out, force=force, quiet=quiet, as_json=as_json)
        return
    if map_path is None or out is None:
        raise InputError(
            f"--{'out' if map_path else 'map'} is missing",
            expected="--map MAP.toml --out DATASET",
            remedy=f"`tsas ingest {sources[0]} --guess --out MAP.toml` proposes a map",
        )
    with progress("ingest", quiet=quiet) as step:
        result = tsas.ingest(sources, map=map_path, out=out, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)


def _guess(
    sources: list[Path],
    map_path: Path | None,
    out: Path | None,
    *,
    force: bool,
    quiet: bool,
    as_json: bool,
) -> None:
    from tsas_cli.files import new_file
    from tsas_cli.recordings.guess.proposal import propose
    from tsas_cli.recordings.guess.summary import content, tables
    from tsas_cli.recordings.ingest import find_files

    if map_path is not None:
        raise InputError("--guess proposes a map, --map takes one", remedy="leave one of them out")
    proposal = propose(find_files(sources, "*"))
    summary = content(proposal)
    if out is not None:
        with new_file(out, force=force) as path:
            path.write_text(summary["map"], encoding="utf-8")
    elif not quiet and not as_json:
        print(summary["map"], end="")
        return
    show(summary, tables(proposal, out), quiet=quiet, as_json=as_json)
