"""What `compare.json` holds: of two models, or of two folders of tracked runs (docs/formats.md)."""

from typing import Any, ClassVar, Literal

from pydantic import Field

from tsas_cli.records.base import Number, ParameterValue, Record, StageFile
from tsas_cli.records.diagnosis import Maps
from tsas_cli.records.tracking import Spread


def shared_name(a: str | None, b: str | None) -> str:
    """Return a run's id; both where the same recording has two.

    >>> shared_name("a", "a"), shared_name("a", "first"), shared_name(None, "b")
    ('a', 'a = first', 'b')
    """
    return " = ".join(dict.fromkeys(name for name in (a, b) if name))


class RecordingsRead(Record):
    """The dataset behind a side, and the checksums of the recordings read, by run id."""

    name: str
    recordings: dict[str, str] | None = None


class ComparedSide(Record):
    """What is compared: where it is, and the checksums of its files."""

    path: str
    kind: str
    files: dict[str, str]


class ModelSide(ComparedSide):
    """A model, or what a stage says of one."""

    dataset: RecordingsRead | None = None
    dynamics: str
    verdict: str | None = None
    reason: str | None = None


class ComparedOn(Record):
    """The dataset that both models are simulated on."""

    SPARSE = frozenset({"chosen"})
    name: str
    hashes: dict[str, str]
    chosen: tuple[str, ...] | None = None


class ValueDifference(Record):
    """B less A in the parameter's unit; without an interval where there is none, and why.

    `excludes_zero` says whether it is more than its uncertainty, None where that is not known.
    """

    value: Number
    low: Number = Field(default=None, alias="interval_low")
    high: Number = Field(default=None, alias="interval_high")
    excludes_zero: bool | None = None
    why_none: str | None = Field(default=None, alias="why_no_interval")


class ParameterPair(Record):
    """One parameter in both models, or in one of them; its runs are the ids that they have there.

    Where both have it the difference is there too.
    """

    name: str
    unit: str
    a: ParameterValue | None = None
    b: ParameterValue | None = None
    difference: ValueDifference | None = None

    @property
    def run(self) -> str:
        """The run that the value belongs to, under both names where they differ."""
        a, b = (None if side is None else side.run for side in (self.a, self.b))
        return shared_name(a, b) or "all"


class EffectPlaces(Record):
    """What an effect is to both sides: named, in the model, a rival, or nothing."""

    effect: str
    a: str
    b: str


class ErrorRow(Record):
    """One channel of one run: the root mean squares of both sides' errors, in its unit.

    `ratio` is B over A; `fitted_a` says whether A's fit has seen the recording, None where that is
    not known.
    """

    run_a: str | None
    run_b: str | None
    channel: str
    unit: str
    rmse_a: Number
    rmse_b: Number
    noise: Number
    fitted_a: bool | None
    fitted_b: bool | None
    ratio: Number = None


class HeldOutPair(Record):
    """One channel's errors on held-out data by two diagnoses, in its unit."""

    channel: str
    unit: str
    rmse_a: Number
    rmse_b: Number
    noise_a: Number
    noise_b: Number


class ComparisonFile(StageFile):
    """What each `compare.json` says."""

    FILE: ClassVar[str] = "compare.json"
    stage: Literal["compare"] = "compare"
    findings: tuple[str, ...]
    notes: tuple[str, ...]
    a: ComparedSide
    b: ComparedSide


class ModelComparison(ComparisonFile):
    """The content of `compare.json` of two models."""

    a: ModelSide
    b: ModelSide
    on: ComparedOn | None = None
    same_recordings: str
    parameters: tuple[ParameterPair, ...]
    effects: tuple[EffectPlaces, ...]
    errors: tuple[ErrorRow, ...]
    held_out: tuple[HeldOutPair, ...]
    residual_map: dict[str, Maps]


class Setting(Record):
    """A setting that differs between the sides; None where a side does not have it."""

    name: str
    a: Any  # whatever a settings file can hold
    b: Any


class ScorePair(Record):
    """One score of one controller under one condition; `ratio` is that of the means, B over A."""

    controller: str
    condition: str
    score: str
    unit: str
    a: Spread
    b: Spread
    ratio: Number = None


class TrackedComparison(ComparisonFile):
    """The content of `compare.json` of two folders of tracked runs."""

    settings: tuple[Setting, ...]
    scores: tuple[ScorePair, ...]
