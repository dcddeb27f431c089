"""`tsas compare`: two models, or what two stages wrote, side by side."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import ChosenRuns, Force, Json, Quiet, opened, progress, show
from tsas_cli.errors import InputError, printable


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

    A and B are model files, or what `tsas calibrate`, `diagnose`, `simulate` or `track` wrote.
    """
    from tsas_cli.comparing import stage, tracked_stage
    from tsas_cli.comparing.compare import compare as compare_sides
    from tsas_cli.comparing.tracked import are_tracked, compare_tracked
    from tsas_cli.files import new_folder, write_json

    tracks = are_tracked(a, b)
    _refuse(on=on, runs=runs, fit_own=fit_own, tracks=tracks)
    data = None if on is None else opened(on, runs)
    with (
        nullcontext() if out is None else new_folder(out, force=force) as folder,
        progress("compare", None, quiet=quiet or as_json) as step,
    ):
        if tracks:
            both = compare_tracked(a, b)
            summary, printed = tracked_stage.as_json(both), tracked_stage.tables(both)
        else:
            it = compare_sides(a, b, on=data, fit_own=fit_own, step=step)
            summary, printed = stage.as_json(it), stage.tables(it)
        if folder is not None:
            from tsas_cli.reporting.comparing.page import comparison_page
            from tsas_cli.reporting.comparing.tracked import tracked_page

            write_json(folder / stage.FILE, summary)
            page = tracked_page(both, step) if tracks else comparison_page(it, step)
            (folder / "report.html").write_text(page, encoding="utf-8")
    show(summary, printed, quiet=quiet, as_json=as_json)
    if not quiet and not as_json:
        for sentence in summary["findings"]:
            print(printable(sentence))
        for sentence in summary["notes"]:
            print(f"- {printable(sentence)}")


def _refuse(*, on: Path | None, runs: str | None, fit_own: bool, tracks: bool) -> None:
    """Refuse options that have nothing to work on."""
    if tracks and on is not None:
        raise InputError("closed loops have recordings of their own", where="--on")
    if on is None and runs is not None:
        raise InputError("there is no dataset to take runs of", where="--runs", remedy="add --on")
    if on is None and fit_own:
        raise InputError(
            "there are no recordings to fit each run's own values to",
            where="--fit-own",
            remedy="add --on DATASET",
        )
