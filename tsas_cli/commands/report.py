"""`tsas report`: one HTML page of what the stages found."""

from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Force, Json, Quiet, progress, show


def report(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR", help="Folders that the stages have written.")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The HTML page to write.")],
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Each DIR is a dataset or what `tsas check`, `calibrate`, `simulate` or `diagnose` wrote. What
    `tsas track` wrote makes a page of its own.
    """
    from tsas_cli.files import new_file
    from tsas_cli.reporting.inputs import read_inputs
    from tsas_cli.reporting.page import SECTIONS, page

    with new_file(out, force=force) as path:
        inputs = read_inputs(folders)
        with progress("drawing", len(SECTIONS), quiet=quiet) as advance:
            path.write_text(page(inputs, advance), encoding="utf-8")
    read = {"dataset.toml": str(inputs.dataset.folder)}
    read |= {kind.FILE: str(folder) for kind, folder in inputs.folders.items()}
    size = out.stat().st_size
    show(
        {"stage": "report", "page": str(out), "bytes": size, "read": read},
        [(f"{out}, {size / 1e6:.2f} MB", ("file", "folder"), list(read.items()))],
        quiet=quiet,
        as_json=as_json,
    )
