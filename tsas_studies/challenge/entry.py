"""What a tool says about the cases of a sealed set: one `ID/diagnosis.json` for each."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from tsas_cli.recordings.manifest import parse
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json
from tsas_studies.challenge.answers import CATALOGUE

FILE = "diagnosis.json"
LOG = "entry.json"
_TWO_SIDED = 1.96  # standard errors on each side of a 95 % interval


class _Record(BaseModel):
    # More keys are welcome in a diagnosis; the score does not read them.
    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)


class Estimate(_Record):
    """One fitted parameter of a named effect."""

    value: float
    stderr: float | None = Field(default=None, ge=0)
    interval_low: float | None = None
    interval_high: float | None = None
    unit: str

    @model_validator(mode="after")
    def _interval_has_two_ends(self) -> "Estimate":
        low, high = self.interval_low, self.interval_high
        if (low is None) != (high is None):
            raise ValueError("interval_low and interval_high go together")
        if low is not None and high is not None and low > high:
            raise ValueError(f"interval_low {low:g} is above interval_high {high:g}")
        return self

    @property
    def interval(self) -> tuple[float, float] | None:
        """The stated 95 % interval, from the standard error where no ends are given."""
        if self.interval_low is not None and self.interval_high is not None:
            return self.interval_low, self.interval_high
        if self.stderr is None:
            return None
        half = _TWO_SIDED * self.stderr
        return self.value - half, self.value + half


class Named(_Record):
    """One named effect, and the effects that the recordings cannot tell from it."""

    effect: str
    rivals: tuple[str, ...] = ()
    parameters: dict[str, Estimate] = {}

    @model_validator(mode="after")
    def _units_are_the_catalogues(self) -> "Named":
        for name, parameter in CATALOGUE.get(self.effect, {}).items():
            estimate = self.parameters.get(name)
            if estimate is not None and estimate.unit != parameter.unit:
                raise ValueError(f"{name} is in {estimate.unit}, expected {parameter.unit}")
        return self


class Channel(_Record):
    """How far the model is from one channel on held-out data, in the channel's unit."""

    rmse_before: float | None = Field(default=None, ge=0)
    rmse_after: float | None = Field(default=None, ge=0)
    best_obtainable: float | None = Field(default=None, ge=0)


class Remainder(_Record):
    """Whether structure is left that no effect in the catalogue accounts for."""

    unexplained: bool


class Diagnosis(_Record):
    """The content of `diagnosis.json`, as far as it is scored."""

    format: Literal[1]
    verdict: Literal["named", "ambiguous", "sufficient", "unexplained", "undecided"]
    named: tuple[Named, ...]
    channels: dict[str, Channel] = {}
    remainder: Remainder
    seconds: float | None = Field(default=None, ge=0)

    @model_validator(mode="after")
    def _named_once(self) -> "Diagnosis":
        names = [named.effect for named in self.named]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"{twice[0]} is named twice")
        return self

    @property
    def effects(self) -> frozenset[str]:
        """The names of the named effects."""
        return frozenset(named.effect for named in self.named)

    @property
    def says_unexplained(self) -> bool:
        """Whether it says that something is there which it has no name for."""
        return self.verdict == "unexplained" or self.remainder.unexplained


class Log(_Record):
    """The content of `entry.json`, which `tsas challenge run` writes: why answers are missing."""

    no_answer: dict[str, str] = {}


@dataclass(frozen=True)
class Entry:
    """The diagnoses of one tool by case, and the reason for each one that is missing."""

    diagnoses: dict[str, Diagnosis]
    no_answer: dict[str, str]


def read_entry(folder: Path, cases: Iterable[str]) -> Entry:
    """Read what a tool says about the given cases.

    Raises
    ------
    InputError
        The folder is missing, a diagnosis in it is malformed, or it answers a case that is not
        in the set.
    """
    cases = list(cases)
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
    reasons = _reasons(folder / LOG)
    return Entry(
        {case: _read_diagnosis(folder / case / FILE) for case in there},
        {case: reasons.get(case, f"no {FILE}") for case in cases if case not in there},
    )


def _read_diagnosis(path: Path) -> Diagnosis:
    return parse(Diagnosis, read_json(path), path)


def _reasons(path: Path) -> dict[str, str]:
    return parse(Log, read_json(path), path).no_answer if path.is_file() else {}
