"""What `check.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.records.base import OfDataset, Record


class Finding(Record):
    """One thing that `tsas check` says about the recordings."""

    code: str
    severity: str
    run: str | None = None
    column: str | None = None
    sentence: str
    remedy: str = ""
    first_s: float | None = None


class NotChecked(Record):
    """A check that could not tell, with the reason."""

    code: str
    run: str | None = None
    reason: str


class Check(OfDataset):
    """The content of `check.json`."""

    FILE: ClassVar[str] = "check.json"
    stage: Literal["check"]
    findings: tuple[Finding, ...]
    not_checked: tuple[NotChecked, ...] = ()
