"""Say what is wrong with recordings."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality import check_dataset
from tsas_cli.recordings.quality.finding import Finding, NotChecked
from tsas_cli.records.check import CheckFile
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, dataset_of, path_of
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True, repr=False, eq=False)
class CheckResult(Result):
    """What the checks found, and which of them could not tell."""

    record: CheckFile  # what `check.json` holds

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is wrong: code, severity, run, column, a sentence, and what to do."""
        return self.record.findings

    @property
    def not_checked(self) -> tuple[NotChecked, ...]:
        """Checks that could not tell, with the reason; this is not the same as passed."""
        return self.record.not_checked

    def tables(self) -> Iterator[Table]:
        """Yield what was found, what to do about it, and what could not be checked."""
        found = [(str(f.severity), f.code, f.run or "", f.sentence) for f in self.findings]
        header = ("severity", "code", "run", "finding") if found else ()
        yield f"the checks found {len(found) or 'nothing'}", header, found
        remedies = dict.fromkeys((f.code, f.remedy) for f in self.findings)
        if remedies:
            yield "what to do", ("code", "remedy"), list(remedies)
        if reasons := self.record.reasons():
            yield "not checked", ("code", "reason", "runs"), reasons


def check(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> CheckResult:
    """Say what is wrong with recordings before anyone fits anything.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `check.json`; None writes nothing.
    runs
        The ids of the runs that are looked at; all without it.
    force
        Replace the folder if it is there.
    step
        Called once for each run.

    Returns
    -------
    CheckResult
        `.findings` and `.not_checked`.

    Raises
    ------
    InputError
        No run can be read, or `out` exists and `force` is not set.
    """
    data, folder = dataset_of(dataset, runs), path_of(out)
    with folder_if(folder, stage="check", inputs=[data.folder], force=force) as written:
        record = CheckFile(**data.header(folder), **vars(check_dataset(data, step)))
        if written is not None:
            record.write(written)
    return CheckResult(record.content(), folder, record)
