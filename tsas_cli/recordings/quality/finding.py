"""Results of a check: what it found in a recording, or the reason why it does not apply."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Generic, Literal, TypeVar

Severity = Literal["error", "warning", "note"]
Subject = TypeVar("Subject")


@dataclass(frozen=True)
class Finding:
    """A fault that a check found; `code` is that of the check, `run` is None for the manifest.

    `error`: results from this run are wrong. `warning`: they may be wrong, or a stage cannot use
    the run. `note`: worth knowing. A check sets no code, and a run only where its subject is the
    whole dataset.
    """

    code: str = field(default="", kw_only=True)
    severity: Severity
    run: str | None = field(default=None, kw_only=True)
    column: str | None
    sentence: str
    remedy: str
    first_s: float | None = None


error, warning = partial(Finding, "error"), partial(Finding, "warning")


@dataclass(frozen=True)
class NotChecked:
    """A check that did not apply, with the reason; it has not passed then."""

    code: str = field(default="", kw_only=True)
    run: str | None = field(default=None, kw_only=True)
    reason: str


Findings = Iterator[Finding | NotChecked]


@dataclass(frozen=True)
class QualityCheck(Generic[Subject]):
    """One check: a function that yields a finding for each fault, or why it does not apply.

    Its docstring says what one sees, how the check decides, and what it can be mistaken for.
    `of_long` is what of a run that is too long for memory is checked: its stretches one by one, or
    the run decimated; for `strokes` the run decimated, if that still shows them, else stretches.
    """

    find: Callable[[Subject], Findings]
    needs: tuple[str, ...] = ()  # columns without which it does not apply
    given: tuple[str, ...] = ()  # what else has to hold of the run, by the names in `GIVEN`
    of_long: Literal["stretches", "decimated", "strokes"] = "stretches"

    @property
    def code(self) -> str:
        """The name of the function, with hyphens."""
        return self.find.__name__.replace("_", "-")

    def results(self, subject: Subject) -> Findings:
        """Yield what it finds, under its code."""
        return (replace(one, code=self.code) for one in self.find(subject))
