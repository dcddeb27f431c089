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
