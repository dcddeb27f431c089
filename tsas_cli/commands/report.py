"""`tsas report`: one HTML page of the results of stages."""

from pathlib import Path
from typing import Annotated

import typer

import tsas_cli as tsas
from tsas_cli.commands.common import Force, Json, Quiet, present, progress


def report(
    folders: Annotated[list[str], typer.Argument(metavar="DIR", help="Output folders of stages.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The HTML page to write.")],
    pdf: Annotated[
        bool, typer.Option("--pdf", help="Also print the page to PDF; requires Chromium.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Each DIR is a dataset or an output of `tsas check`, `calibrate`, `simulate` or `diagnose`. An
    output of `tsas track`, `close-loop` or `identify-harmonic-drive` has a page of its own. Several
    simulations stand beside each other, each by the name of its folder.

    With `--pdf`, report.html is also printed to report.pdf.
    """
    with progress("report", quiet=quiet) as step:
        result = tsas.report(folders, out=out, pdf=pdf, force=force, step=step)
    present(result, quiet=quiet, as_json=as_json)
