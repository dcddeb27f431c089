"""Say what is wrong with recordings."""

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality import CODES, check_dataset, check_runs
from tsas_cli.recordings.quality.finding import Finding, NotChecked
from tsas_cli.records.check import CheckFile
from tsas_cli.records.result import Result, Table
from tsas_cli.stages.given import Named, dataset_of, listed, one_of, path_of
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.wording import count_of

_SHOWN_BY = {
    "x_in_mm": "the stiffness of the tendon, motion lost at the drive and errors of the proximal "
    "position sensor cannot be judged",
    "x_out_mm": "motion lost at the load and errors of the distal position sensor cannot be judged",
    "f_in_N": "the level of friction rests on the stiffness of the tendon, and errors of the "
    "proximal force sensor cannot be judged",
    "f_out_N": "the tension at the load rests on its stiffness, and errors of the distal force "
    "sensor cannot be judged",
}


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


def errors_and_warnings(
    dataset: Dataset, despite: str | Iterable[str], step: Steps, further: Sequence[str] = ()
) -> dict[str, tuple[Finding, ...]]:
    """Return what the checks find: the errors whose codes are in `despite`, and the warnings.

    By their names in `OfDataset`. `further` codes are allowed in `despite` too; `step` counts runs.

    Raises
    ------
    InputError
        There is an error of another code, or `despite` holds what is no code of a check.
    """
    accepted = {one_of((*CODES, *further), code, "despite") for code in listed(despite)}
    found = [one for one in check_runs(dataset, step).findings if one.code in CODES]
    errors = [one for one in found if one.severity == "error"]
    refused = [one for one in errors if one.code not in accepted]
    if refused:
        first, *others = refused
        files = {run.id: run.file for run in dataset.runs}
        options = " ".join(f"--despite {code}" for code in dict.fromkeys(f.code for f in refused))
        more = f" (and {count_of(len(others), 'more error')})" if others else ""
        raise InputError(
            f"{first.sentence}{more}",
            where=MANIFEST_FILE if first.run is None else files[first.run],
            remedy=f"{first.remedy}, or accept what `tsas check` finds with {options}",
        )
    warnings = [one for one in found if one.severity == "warning"]
    return {"despite": tuple(errors), "warnings": tuple(warnings)}


def unrecorded(columns: Sequence[Container[str]]) -> Iterator[str]:
    """Yield a sentence for each missing displacement or tension: what cannot be judged without it.

    `columns` holds the names of those that each run has.
    """
    for name, cannot in _SHOWN_BY.items():
        without = sum(name not in names for names in columns)
        if without:
            where = "" if without == len(columns) else f" in {without} of {len(columns)} runs"
            yield f"{name.rpartition('_')[0]} is not recorded{where}: without it, {cannot}."
