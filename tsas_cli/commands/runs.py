"""`tsas runs QUERY`: find runs among those of many datasets."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, names, present
from tsas_cli.commands.completion import run_columns, sort_columns
from tsas_cli.commands.progress import progress
from tsas_cli.support.errors import InputError


def runs(
    query: Annotated[
        str, typer.Argument(metavar="QUERY", help="A condition in SQL; all runs without it.")
    ] = "",
    folders: Annotated[
        list[Path] | None,
        typer.Option("--in", metavar="DIR", help="Where to look, once or more; else here."),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES", help="What is told, with commas.", autocompletion=run_columns
        ),
    ] = None,
    sort: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns to sort by; -NAME the other way round.",
            autocompletion=sort_columns,
        ),
    ] = None,
    limit: Annotated[int | None, typer.Option(min=0, help="How many runs at most.")] = None,
    paths: Annotated[
        bool, typer.Option("--paths", help="Print the datasets' folders alone, one a line.")
    ] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Find runs among those of all datasets below a folder, by conditions, signals and verdicts.

    For example: tsas runs 'total_bend_rad > 3 and f_out in channels and started >= 2026-01'
    """
    if paths and as_json:
        raise InputError("--paths and --json are two outputs", remedy="leave one out")
    with progress("index", quiet=quiet) as step:
        result = tsas.runs(
            query,
            folders or ".",
            columns=names(columns) or (),
            sort=names(sort) or (),
            limit=limit,
            step=step,
        )
    if paths and not quiet:
        for path in result.paths:
            print(path)
    elif not paths:
        present(result, quiet=quiet, as_json=as_json)
