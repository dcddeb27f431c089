"""`tsas compare`: compare two models, or the outputs of two stages."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import ChosenRuns, Force, Json, Quiet, names, present, progress


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A model, or a stage's folder.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="The other model or folder.")],
    on: Annotated[
        str | None,
        typer.Option(metavar="DATASET", help="Simulate both models on these recordings."),
    ] = None,
    runs: ChosenRuns = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Also write DIR/compare.json and DIR/report.html."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Compare two models or results, and test whether they differ by more than the uncertainty.

    A and B are model files, or outputs of `tsas calibrate`, `diagnose`, `simulate` or `track`.
    """
    with progress("compare", quiet=quiet) as step:
        result = tsas.compare(a, b, out=out, on=on, runs=names(runs), force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
