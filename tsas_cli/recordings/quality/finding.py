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


Remarks = Iterator[Remark | CannotTell]


@dataclass(frozen=True)
class QualityCheck(Generic[Subject]):
    """One check: a function that yields a remark for each fault, or why it does not apply.

    Its docstring says what one sees, how the check decides, and what it can be mistaken for.
    `of_long` is what of a run that is too long for memory is checked: its stretches one by one, or
    the run decimated; for `strokes` the run decimated, if that still shows them, else stretches.
    """

    find: Callable[[Subject], Remarks]
    needs: tuple[str, ...] = ()  # columns without which it does not apply
    of_long: Literal["stretches", "decimated", "strokes"] = "stretches"

    @property
    def code(self) -> str:
        """The name of the function, with hyphens."""
        return self.find.__name__.replace("_", "-")


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
