"""What `check.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.recordings.quality.finding import Finding, NotChecked
from tsas_cli.records.base import OfDataset


class CheckFile(OfDataset):
    """The content of `check.json`."""

    FILE: ClassVar[str] = "check.json"
    stage: Literal["check"] = "check"
    findings: tuple[Finding, ...]
    not_checked: tuple[NotChecked, ...] = ()

    def reasons(self) -> list[tuple[str, str, str]]:
        """Return code, reason and runs of what could not be checked, each reason once."""
        runs: dict[tuple[str, str], list[str]] = {}
        for silent in self.not_checked:
            runs.setdefault((silent.code, silent.reason), []).append(silent.run or "")
        return [(*key, ", ".join(ids)) for key, ids in runs.items()]
