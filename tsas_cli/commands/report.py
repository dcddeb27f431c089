"""`tsas report`: one HTML page of what the stages found."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present
from tsas_cli.commands.progress import progress


def report(
    folders: Annotated[
        list[str], typer.Argument(metavar="DIR", help="Folders that the stages have written.")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The HTML page to write.")],
    pdf: Annotated[
        bool, typer.Option("--pdf", help="Write it as PDF beside the page too; needs Chromium.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Each DIR is a dataset or what `tsas check`, `calibrate`, `simulate` or `diagnose` wrote. What
    `tsas track`, `close-loop` or `identify-harmonic-drive` wrote makes a page of its own.

    With `--pdf` report.html is printed to report.pdf beside it.
    """
    with progress("report", quiet=quiet) as step:
        result = tsas.report(folders, out=out, pdf=pdf, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
