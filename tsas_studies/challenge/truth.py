"""The truth of a sealed set, `answers.json`: what it says and how it is checked."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from tsas_cli.effects import EFFECTS
from tsas_cli.effects.effect import Parameter
from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import Record
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import read_json
from tsas_studies.challenge.cases import Kind
from tsas_studies.challenge.conditions import Conditions
from tsas_studies.challenge.near import MIXED
from tsas_studies.challenge.recording_faults import RECORDING_FAULTS
from tsas_studies.challenge.right_kind import RIGHT_KIND

FILE = "answers.json"
CaseId = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
CATALOGUE: dict[str, dict[str, Parameter]] = {
    effect.name: {p.name: p for p in effect.parameters} for effect in EFFECTS
}
OUTSIDE: tuple[Kind, ...] = ("unknown", "near")  # mechanisms that the catalogue does not hold
BEYOND: tuple[Kind, ...] = (
    *OUTSIDE,
    "fault",
    "recording",
)  # what is hidden need not be in the catalogue
_HIDDEN: dict[Kind, int] = {"one": 1, "pair": 2, "triple": 3}  # 0 for the others


class HiddenEffect(Record):
    """One hidden effect and the values that its parameters have."""

    effect: str
    parameters: dict[str, float]

    @model_validator(mode="after")
    def _in_the_catalogue(self) -> "HiddenEffect":
        if self.effect not in CATALOGUE:
            raise ValueError(f"unknown effect {self.effect} ({nearest(self.effect, CATALOGUE)})")
        known = CATALOGUE[self.effect]
        for name in self.parameters:
            if name not in known:
                raise ValueError(f"{self.effect} has no parameter {name} ({nearest(name, known)})")
        return self


class TrueCase(Record):
    """One case: what is hidden in it, and how large it is beside the full size."""

    kind: Kind
    size: float | None = Field(default=None, ge=0)
    hidden: tuple[HiddenEffect, ...] = ()
    unknown: str | None = None
    unknown_parameters: dict[str, Any] = Field(default_factory=dict)
    conditions: Conditions = "clean"
    sums: dict[str, str] = Field(default_factory=dict)  # SHA-256 of each file of its dataset

    @property
    def effects(self) -> frozenset[str]:
        """The names of the hidden effects."""
        return frozenset(hidden.effect for hidden in self.hidden)

    @property
    def right(self) -> frozenset[str]:
        """The names that are right: the hidden effects, or fair ones for what is none."""
        if self.unknown is None:
            return self.effects
        if self.kind == "recording" and self.unknown in RECORDING_FAULTS:
            return frozenset(RECORDING_FAULTS[self.unknown].right)
        parts = self.unknown_parameters if self.unknown == MIXED else (self.unknown,)
        return frozenset(name for part in parts for name in (part, *RIGHT_KIND.get(part, ())))

    @model_validator(mode="after")
    def _kind_fits(self) -> "TrueCase":
        count = _HIDDEN.get(self.kind, 0)
        if len(self.effects) != count or len(self.hidden) != count:
            raise ValueError(
                f"kind {self.kind} goes with {count} hidden effects, got {len(self.hidden)}"
            )
        if (self.unknown is not None) != (self.kind in BEYOND):
            raise ValueError(
                f"unknown is given for the kinds {' and '.join(BEYOND)}, and only there"
            )
        if self.kind == "one" and self.size is None:
            raise ValueError("size is missing")
        return self


class Truth(Record):
    """The whole file."""

    format: Literal[1]
    kind: Literal["challenge-answers"]
    seed: int | tuple[int, ...]
    salt: str = Field(default="", pattern="^([0-9a-f]{32})?$")
    cases: dict[CaseId, TrueCase] = Field(min_length=1)


def read_truth(folder: Path) -> Truth:
    """Read and check `answers.json` in the folder of a sealed set.

    InputError: it is missing, is not JSON, or says something that its format does not allow.
    """
    path = folder / FILE
    if not path.is_file():
        raise InputError(
            f"no {FILE} here",
            where=folder,
            expected="the folder of a sealed set",
            remedy="make one with `tsas challenge make`",
        )
    return parse(Truth, read_json(path), path)
