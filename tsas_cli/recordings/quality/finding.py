"""What a check says: a remark about a recording, or that it cannot tell."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

Severity = Literal["error", "warning", "note"]
Subject = TypeVar("Subject")


@dataclass(frozen=True)
class Remark:
    """Something that is wrong, as one check sees it.

    `error`: results from this run are wrong. `warning`: they may be wrong, or a stage cannot use
    the run. `note`: worth knowing. A check of a whole dataset says which `run` it means.
    """

    severity: Severity
    sentence: str
    remedy: str
    column: str | None = None
    first_s: float | None = None
    run: str | None = None


@dataclass(frozen=True)
class CannotTell:
    """Why a check does not apply; this is not the same as passed."""

    reason: str
    run: str | None = None


@dataclass(frozen=True)
class Check(Generic[Subject]):
    """One check: its code, what it needs, and the function that looks.

    Parameters
    ----------
    code
        The name of the check's module, with hyphens.
    find
        Yields a remark for each thing that is wrong, and a reason where it cannot tell.
    needs
        Columns without which the check does not apply.
    """

    code: str
    find: Callable[[Subject], Iterator[Remark | CannotTell]]
    needs: tuple[str, ...] = ()

    @property
    def explanation(self) -> str:
        """The text that a person reads: the docstring of the check's module."""
        return (sys.modules[self.find.__module__].__doc__ or "").strip()


@dataclass(frozen=True)
class Finding:
    """A remark with the check and the run that it belongs to (`run` is None for the manifest)."""

    code: str
    severity: Severity
    run: str | None
    column: str | None
    sentence: str
    remedy: str
    first_s: float | None = None


@dataclass(frozen=True)
class NotChecked:
    """A check that could not tell, with the reason."""

    code: str
    run: str | None
    reason: str
