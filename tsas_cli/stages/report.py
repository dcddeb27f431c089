"""Write one HTML page of what the stages found."""

from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.storage import Location
from tsas_cli.records.result import Result, Table
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import SECTIONS, page
from tsas_cli.reporting.pdf import PDF_MARK, browser, print_page
from tsas_cli.stages.given import Named, file_of, place_of, several_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_file
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.verifying.claims import PAGE_MARK, with_seal


@dataclass(frozen=True, repr=False, eq=False)
class ReportResult(Result):
    """A page that was written, and from what; `out` is the page."""

    sizes: dict[str, int]  # of each file that was written [bytes]

    def tables(self) -> list[Table]:
        """Return what was read."""
        title = "; ".join(f"{path}, {size / 1e6:.2f} MB" for path, size in self.sizes.items())
        return [(title, ("file", "folder"), list(self.summary["read"].items()))]


def report(
    folders: Named | Iterable[Named],
    *,
    out: Named,
    pdf: bool = False,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> ReportResult:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Parameters
    ----------
    folders
        A dataset's folder or address, and the folders that the stages have written, one of each
        kind, but any number of simulations.
    out
        The HTML file to write.
    pdf
        Print it to a PDF beside it too, with Chromium.
    force
        Replace what is there.
    step
        Called once for each section.

    Returns
    -------
    ReportResult
        `.out` is the page, `.summary` says what was read.

    Raises
    ------
    InputError
        A folder is of no known kind, does not belong to the dataset, `out` exists and `force` is
        not set, or there is no Chromium to print with.
    """
    pages, places = [file_of(out)], [place_of(each) for each in several_of(folders)]
    if pdf:
        browser()  # before the work, where there is none
        pages.append(_beside(Path(out)))
    with ExitStack() as stack:
        written = partial(new_file, inputs=places, force=force)
        html, *printed = (
            stack.enter_context(written(path, mark=mark))
            for path, mark in zip(pages, (PAGE_MARK, PDF_MARK), strict=False)
        )
        inputs = read_inputs(places, several=True)
        step.ahead(len(SECTIONS))
        # The files that say what was read, by which all else is found.
        files: list[tuple[Location, str]] = [(folder, one.FILE) for one, folder in inputs.given]
        if inputs.dataset is not None:
            files.insert(0, (inputs.dataset.folder, MANIFEST_FILE))
        text = with_seal(page(inputs, step), files, pages[0])
        html.write_text(text, encoding="utf-8")
        for path in printed:
            print_page(text, path)
    read = {} if inputs.dataset is None else {"dataset.toml": str(inputs.dataset.folder)}
    read |= {stage.FILE: str(folder) for stage, folder in inputs.given}
    if len(every := inputs.simulations) > 1:
        del read[SimulationFile.FILE]
        read |= {f"{SimulationFile.FILE}, {name}": str(path) for name, (_, path) in every.items()}
    sizes = {str(path): path.stat().st_size for path in pages}
    summary = {"stage": "report", "page": str(out), "bytes": sizes[str(pages[0])], "read": read}
    if pdf:
        summary["pdf"] = str(pages[1])
    return ReportResult(summary, pages[0], sizes)


def _beside(out: Path) -> Path:
    """Return where the PDF goes, which must not be where the page goes."""
    path = out.with_suffix(".pdf")
    if path == out:
        raise InputError(
            "is the name of the PDF",
            where=out,
            expected="another name for the page",
            remedy="choose an --out that ends in .html",
        )
    return path
