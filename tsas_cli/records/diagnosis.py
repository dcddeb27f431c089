"""What `diagnosis.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tsas_cli.records.base import Evidence, ModelFile, OfDataset, Record, Segment

EXTENDED_MODEL, NOMINAL_MODEL = "model-extended.toml", "model-nominal.toml"


class CauseParameter(Record):
    """One parameter of a named cause, with its 95 % interval where it has one."""

    value: float | None
    stderr: float | None = None
    unit: str
    at_bound: bool = False
    interval_low: float | None = None
    interval_high: float | None = None


class Cause(Record):
    """An effect that the diagnosis names; `rivals` are those that may be it just as well."""

    effect: str
    title: str = ""
    equation: str = ""
    rivals: tuple[str, ...] = ()
    parameters: dict[str, CauseParameter] = {}
    gain_percent: float | None = None
    gain_interval_percent: tuple[float, float] | None = None


class HeldOut(Record):
    """One channel's error on data that no fit has seen, in its unit."""

    unit: str = ""
    rmse_before: float | None
    rmse_after: float | None
    noise_floor: float | None = None
    best_obtainable: float | None = None


class Remainder(Record):
    """What is left; `mean_square` is in units of what noise explains."""

    unexplained: bool = False
    depends_on: tuple[str, ...] = ()
    share_percent: float | None = None
    mean_square: float | None = None


class Candidate(Record):
    """One hypothesis that was fitted, and by how much it lowers the error on held-out data."""

    effects: tuple[str, ...]
    gain_percent: float | None = None
    sureness: float | None = None
    convincing: bool = False
    mean_square: float | None = None
    converged: bool = True


class Signatures(Record):
    """How visible each effect is in these inputs, and how much each two look alike, 0 to 1."""

    effects: tuple[str, ...] = ()
    visible: tuple[float, ...] = ()
    likeness: tuple[tuple[float, ...], ...] = ()

    @model_validator(mode="after")
    def _is_square(self) -> Self:
        count = len(self.effects)
        if any(len(row) != count for row in (self.visible, self.likeness, *self.likeness)):
            raise ValueError("visible and likeness need a value for each effect, and for each two")
        return self


class Bin(Record):
    """The error where a signal lies between two values, in units of noise."""

    low: float | None = Field(default=None, alias="from")
    high: float | None = Field(default=None, alias="to")
    label: str = ""
    mean: float
    sd: float
    samples: int


class ResidualMaps(Record):
    """The error of each channel over each signal, before and after."""

    before: dict[str, dict[str, tuple[Bin, ...]]] = {}
    after: dict[str, dict[str, tuple[Bin, ...]]] = {}


class Diagnosis(OfDataset):
    """The content of `diagnosis.json`."""

    FILE: ClassVar[str] = "diagnosis.json"
    stage: Literal["diagnose"]
    version: str
    verdict: Literal["named", "ambiguous", "sufficient", "unexplained", "undecided"]
    reason: str
    model: ModelFile = ModelFile(file="data sheet")
    named: tuple[Cause, ...] = ()
    channels: dict[str, HeldOut] = {}
    remainder: Remainder = Remainder()
    next_experiment: str = ""
    candidates: tuple[Candidate, ...] = ()
    signatures: Signatures = Signatures()
    residual_map: ResidualMaps = ResidualMaps()
    evidence: Evidence = Evidence()
    cannot_tell: tuple[str, ...] = ()
    solver: str = ""
    segments: dict[str, tuple[Segment, ...]] = {}
