"""Compute the source paper's tables and figures again."""

from collections.abc import Sequence
from dataclasses import dataclass

from tsas_cli.paper import yang2025
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, path_of
from tsas_cli.support.files import folder_if, write_json
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_studies.reproduction import GROUPS
from tsas_studies.reproduction.group import Group
from tsas_studies.reproduction.page import reproduction_page
from tsas_studies.reproduction.summary import sentence, summary_of, verdict_table


@dataclass(frozen=True, repr=False, eq=False)
class ReproductionResult(Result):
    """What agrees with the paper, and what does not."""

    groups: Sequence[Group]  # one for each table or figure, with its rows and figures

    def tables(self) -> list[Table]:
        """Return how many rows have which verdict."""
        title = "verdicts" if self.out is None else str(self.out / "index.html")
        return [(title, *verdict_table(self.groups))]

    def sentences(self) -> list[str]:
        """Return the outcome in one sentence."""
        return [sentence(self.groups)]


def reproduce(
    *, out: Named | None = None, force: bool = False, step: Steps = NO_PROGRESS
) -> ReproductionResult:
    """Compute the tables and figures of Yang et al. 2025 again, and say what agrees.

    Parameters
    ----------
    out
        Where to write `reproduction.json` and the page `index.html`; None writes nothing.
    force
        Replace the folder if it is there.
    step
        Called once for each table or figure.

    Returns
    -------
    ReproductionResult
        `.groups` holds each number and statement with its unit, verdict, criterion and reason.

    Raises
    ------
    InputError
        `out` exists and `force` is not set.
    """
    paper, folder = yang2025(), path_of(out)
    with folder_if(folder, stage="reproduce", inputs=(), force=force) as written:
        groups: list[Group] = []
        step.ahead(len(GROUPS))
        for group in GROUPS:
            groups.append(group(paper))
            step()
        summary = summary_of(paper, groups)
        if written is not None:
            write_json(written / "reproduction.json", summary)
            page = reproduction_page(paper, groups)
            (written / "index.html").write_text(page, encoding="utf-8")
    return ReproductionResult(summary, folder, groups)
