"""Write one HTML page of what the stages found."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.api.given import Named
from tsas_cli.files import new_file
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import SECTIONS, page
from tsas_cli.result import Result, Table
from tsas_cli.steps import SILENT, Steps


@dataclass(frozen=True, repr=False, eq=False)
class ReportResult(Result):
    """A page that was written, and from what; `out` is the page."""

    def tables(self) -> list[Table]:
        """Return what was read."""
        title = f"{self.out}, {self.summary['bytes'] / 1e6:.2f} MB"
        return [(title, ("file", "folder"), list(self.summary["read"].items()))]


def report(
    folders: Named | Iterable[Named],
    *,
    out: Named,
    force: bool = False,
    step: Steps = SILENT,
) -> ReportResult:
    """Write one self-contained HTML page: diagnosis, recordings, model, simulation and residual.

    Parameters
    ----------
    folders
        A dataset's folder and those that the stages have written, one of each kind.
    out
        The HTML file to write.
    force
        Replace the file if it is there.
    step
        Told of a piece of work per section.

    Returns
    -------
    ReportResult
        `.out` is the page, `.summary` says what was read.

    Raises
    ------
    InputError
        A folder is of no known kind, does not belong to the dataset, or `out` exists and `force`
        is not set.
    """
    listed = [folders] if isinstance(folders, str | Path) else list(folders)
    page_path = Path(out)
    with new_file(page_path, force=force) as path:
        inputs = read_inputs([Path(folder) for folder in listed])
        step.ahead(len(SECTIONS))
        path.write_text(page(inputs, step), encoding="utf-8")
    read = {} if inputs.dataset is None else {"dataset.toml": str(inputs.dataset.folder)}
    read |= {kind.FILE: str(folder) for kind, folder in inputs.folders.items()}
    size = page_path.stat().st_size
    summary = {"stage": "report", "page": str(page_path), "bytes": size, "read": read}
    return ReportResult(summary, page_path)
