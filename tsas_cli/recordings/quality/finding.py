"""Results of a check: a remark about a recording, or the reason why it does not apply."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

Severity = Literal["error", "warning", "note"]
Subject = TypeVar("Subject")


@dataclass(frozen=True)
class Remark:
    """A fault that a check found.

    `error`: results from this run are wrong. `warning`: they may be wrong, or a stage cannot use
    the run. `note`: worth knowing. A check of a whole dataset sets `run`.
    """

    severity: Severity
    sentence: str
    remedy: str
    column: str | None = None
    first_s: float | None = None
    run: str | None = None


@dataclass(frozen=True)
class CannotTell:
    """The reason why a check does not apply; it has not passed then."""

    reason: str
    run: str | None = None


@dataclass(frozen=True)
class QualityCheck(Generic[Subject]):
    """One check: its code, its function and the columns it needs.

    Parameters
    ----------
    code
        The name of the check's module, with hyphens.
    find
        Yields a remark for each fault, and a reason if the check does not apply.
    needs
        Columns without which the check does not apply.
    of_long
        What of a run that is too long for memory is checked: its stretches one by one, or the run
        decimated; for `strokes` the run decimated, if that still shows them, else its stretches.
    """

    code: str
    find: Callable[[Subject], Iterator[Remark | CannotTell]]
    needs: tuple[str, ...] = ()
    of_long: Literal["stretches", "decimated", "strokes"] = "stretches"


@dataclass(frozen=True)
class Finding:
    """A remark with its check and its run (`run` is None for the manifest)."""

    code: str
    severity: Severity
    run: str | None
    column: str | None
    sentence: str
    remedy: str
    first_s: float | None = None


@dataclass(frozen=True)
class NotChecked:
    """A check that did not apply, with the reason."""

    code: str
    run: str | None
    reason: str
