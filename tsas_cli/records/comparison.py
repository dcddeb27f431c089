"""What `compare.json` holds: of two models, or of two folders of tracked runs (docs/formats.md)."""

from typing import Any, ClassVar, Literal

from tsas_cli.records.base import Number, Parameter, Record, StageFile
from tsas_cli.records.diagnosis import Maps
from tsas_cli.records.tracking import Spread


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
    """B less A; without an interval where there is none, and why."""

    value: Number
    interval_low: Number = None
    interval_high: Number = None
    excludes_zero: bool | None = None
    why_no_interval: str | None = None


class ParameterPair(Record):
    """One parameter in both models, or in one of them."""

    name: str
    unit: str
    a: Parameter | None = None
    b: Parameter | None = None
    difference: ValueDifference | None = None


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


class ModelComparison(ComparisonFile):
    """The content of `compare.json` of two models."""

    a: ModelSide
    b: ModelSide
    on: ComparedOn | None = None
    own_values_fitted: bool
    same_recordings: str
    parameters: tuple[ParameterPair, ...]
    effects: tuple[EffectPlaces, ...]
    errors: tuple[ErrorRow, ...]
    held_out: tuple[HeldOutPair, ...]
    residual_map: dict[str, Maps]


class Setting(Record):
    """Something that was asked for in another way; None where a side does not have it."""

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

    a: ComparedSide
    b: ComparedSide
    settings: tuple[Setting, ...]
    scores: tuple[ScorePair, ...]
