"""`tsas runs QUERY`: find runs in many datasets."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Json, Quiet, names, present, progress
from tsas_cli.commands.completion import run_columns, sort_columns
from tsas_cli.support.errors import InputError


def runs(
    query: Annotated[
        str, typer.Argument(metavar="QUERY", help="A condition in SQL; default: all runs.")
    ] = "",
    folders: Annotated[
        list[Path] | None,
        typer.Option("--in", metavar="DIR", help="A folder to search; repeatable; default: here."),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES", help="Columns to print, comma-separated.", autocompletion=run_columns
        ),
    ] = None,
    sort: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns to sort by; -NAME: descending.",
            autocompletion=sort_columns,
        ),
    ] = None,
    limit: Annotated[int | None, typer.Option(min=0, help="Largest number of runs.")] = None,
    paths: Annotated[
        bool, typer.Option("--paths", help="Print only the datasets' folders, one per line.")
    ] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Find runs in all datasets below a folder, by conditions, channels and verdicts.

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
