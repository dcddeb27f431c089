"""`tsas report`: one HTML page of what the stages found."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from tsas_cli.commands.common import Force, Json, Quiet, progress, show


def report(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR", help="Folders that the stages have written.")
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
    from tsas_cli.files import new_file
    from tsas_cli.reporting.inputs import read_inputs
    from tsas_cli.reporting.page import SECTIONS, page
    from tsas_cli.reporting.pdf import browser, print_page

    pages = [out]
    if pdf:
        browser()  # before the work, where there is none
        pages.append(_beside(out))
    with ExitStack() as stack:
        html, *printed = (stack.enter_context(new_file(path, force=force)) for path in pages)
        inputs = read_inputs(folders)
        with progress("drawing", len(SECTIONS), quiet=quiet) as advance:
            text = page(inputs, advance)
        html.write_text(text, encoding="utf-8")
        for path in printed:
            print_page(text, path)
    read = {} if inputs.dataset is None else {"dataset.toml": str(inputs.dataset.folder)}
    read |= {kind.FILE: str(folder) for kind, folder in inputs.folders.items()}
    sizes = [path.stat().st_size for path in pages]
    summary = {"stage": "report", "page": str(out), "bytes": sizes[0], "read": read}
    if pdf:
        summary["pdf"] = str(pages[1])
    written = "; ".join(
        f"{path}, {size / 1e6:.2f} MB" for path, size in zip(pages, sizes, strict=True)
    )
    show(
        summary,
        [(written, ("file", "folder"), list(read.items()))],
        quiet=quiet,
        as_json=as_json,
    )


def _beside(out: Path) -> Path:
    """Return where the PDF goes, which must not be where the page goes."""
    from tsas_cli.errors import InputError

    path = out.with_suffix(".pdf")
    if path == out:
        raise InputError(
            "is the name of the PDF",
            where=out,
            expected="another name for the page",
            remedy="choose an --out that ends in .html",
        )
    return path
