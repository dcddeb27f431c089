"""What a tool says about the cases of a sealed set: one `ID/diagnosis.json` for each."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field

from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import Record
from tsas_cli.records.diagnosis import DiagnosisFile, Findings
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json
from tsas_studies.challenge.sums import check_said

FILE = DiagnosisFile.FILE
LOG = "entry.json"


class SubmittedDiagnosis(Findings):
    """What a tool says about one case, and how long that took."""

    seconds: float | None = Field(default=None, ge=0)

    @property
    def said(self) -> frozenset[str]:
        """The named effects with their rivals, and the codes of the faults that are found."""
        rivals = {rival for named in self.named for rival in named.rivals}
        return self.effects | rivals | {fault.code for fault in self.faults}


class Log(Record):
    """The content of `entry.json`, which `tsas challenge run` writes: why answers are missing."""

    no_answer: Mapping[str, str] = Field(default_factory=dict)


@dataclass(frozen=True)
class Entry:
    """The diagnoses of one tool by case, and the reason for each one that is missing."""

    diagnoses: dict[str, SubmittedDiagnosis]
    no_answer: dict[str, str]


def read_entry(
    folder: Path, cases: Iterable[str], sums: Mapping[str, Mapping[str, str]] | None = None
) -> Entry:
    """Read what a tool says about the given cases; `sums` are those of their recordings, by case.

    InputError: the folder is missing, a diagnosis in it is malformed or of other recordings, or it
    answers a case that is not in the set.
    """
    cases, sums = list(cases), sums or {}
    if not folder.is_dir():
        raise InputError("no such folder", where=folder, expected=f"a folder with ID/{FILE}")
    for path in sorted(folder.glob(f"*/{FILE}")):
        if path.parent.name not in cases:
            raise InputError(
                f"{path.parent.name} is not a case of this set",
                where=path,
                remedy="give the set that the entry answers",
            )
    there = [case for case in cases if (folder / case / FILE).is_file()]
    log = folder / LOG
    reasons = parse(Log, read_json(log), log).no_answer if log.is_file() else {}
    diagnoses = {case: read_diagnosis(folder / case / FILE, sums.get(case, {})) for case in there}
    missing = {case: reasons.get(case, f"no {FILE}") for case in cases if case not in there}
    return Entry(diagnoses, missing)


def read_diagnosis(path: Path, sums: Mapping[str, str]) -> SubmittedDiagnosis:
    """Read what a tool says about a case; InputError: it is malformed or of other recordings."""
    content = read_json(path)
    check_said(content, sums, path)
    return parse(SubmittedDiagnosis, content, path)
