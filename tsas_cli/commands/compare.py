"""`tsas compare`: two models, or what two stages wrote, side by side."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import ChosenRuns, Force, Json, Quiet, opened, progress, show
from tsas_cli.errors import InputError


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A model, or a stage's folder.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="What it is compared with, likewise.")],
    on: Annotated[
        Path | None,
        typer.Option(metavar="DATASET", help="Simulate both models on these recordings."),
    ] = None,
    fit_own: Annotated[
        bool,
        typer.Option(help="With --on: fit each run's own preload and zeros first."),
    ] = False,
    runs: ChosenRuns = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Also write DIR/compare.json and DIR/report.html."),
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Say what differs between two models, and whether that is more than the uncertainty.

    A and B are model files, or what `tsas calibrate`, `diagnose` or `simulate` wrote.
    """
    from tsas_cli.comparing.compare import compare as compare_sides
    from tsas_cli.comparing.stage import FILE, tables
    from tsas_cli.comparing.stage import as_json as content_of
    from tsas_cli.files import new_folder, write_json

    if runs is not None and on is None:
        raise InputError("there is no dataset to take runs of", where="--runs", remedy="add --on")
    data = None if on is None else opened(on, runs)
    with (
        nullcontext() if out is None else new_folder(out, force=force) as folder,
        progress("compare", None, quiet=quiet or as_json) as step,
    ):
        it = compare_sides(a, b, on=data, fit_own=fit_own, step=step)
        summary = content_of(it)
        if folder is not None:
            from tsas_cli.reporting.comparing.page import comparison_page

            write_json(folder / FILE, summary)
            (folder / "report.html").write_text(comparison_page(it, step), encoding="utf-8")
    show(summary, tables(it), quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["findings"]:
            print(sentence)
        for sentence in summary["notes"]:
            print(f"- {sentence}")
