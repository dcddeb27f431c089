"""What the stages' JSON files hold, as far as the page reads them (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field


class Record(BaseModel):
    """What a stage has written down, as far as the page reads it."""

    # The stages may say more than the page shows.
    model_config = ConfigDict(frozen=True, extra="ignore")


class Source(Record):
    """The dataset that a stage has read: where it is, relative to the stage's folder."""

    name: str
    folder: str
    hashes: dict[str, str]


class StageFile(Record):
    """What all stages say; `FILE` is the file's name."""

    FILE: ClassVar[str]
    format: Literal[1]


class OfDataset(StageFile):
    """What a stage says that has read a dataset; `chosen` are the runs, None where it is all."""

    dataset: Source
    chosen: tuple[str, ...] | None = None


class Finding(Record):
    """One thing that `tsas check` says about the recordings."""

    code: str
    severity: str
    run: str | None = None
    column: str | None = None
    sentence: str
    remedy: str = ""
    first_s: float | None = None


class NotChecked(Record):
    """A check that could not tell, with the reason."""

    code: str
    run: str | None = None
    reason: str


class Check(OfDataset):
    """The content of `check.json`."""

    FILE: ClassVar[str] = "check.json"
    stage: Literal["check"]
    findings: tuple[Finding, ...]
    not_checked: tuple[NotChecked, ...] = ()


class Segment(Record):
    """A stretch of one run that is in one phase, from `start_s` up to and with `end_s`."""

    start_s: float
    end_s: float
    phase: str


class Parameter(Record):
    """One value with its 95 % interval; None where it has none."""

    name: str
    run: str | None = None
    value: float | None
    stderr: float | None = None
    interval_low: float | None = None
    interval_high: float | None = None
    unit: str
    at_bound: bool = False
    origin: str


class Stiffness(Record):
    """One phase of one run: its stiffness as fitted, by theory, and as a fit should find it."""

    run: str
    phase: str
    km: Parameter
    kr: Parameter | None = None
    theory_N_per_mm: float | None = None
    theory_elastic_N_per_mm: float | None = None
    expected_N_per_mm: float | None = None
    occurrences: int
    note: str | None = None


class Channel(Record):
    """How far a simulated channel is from the measured one, and how noisy that is."""

    rmse: float | None
    noise: float | None
    unit: str | None = None


class Fit(Record):
    """How the joint fit ended."""

    converged: bool
    message: str = ""


class ModelFile(Record):
    """The model that a stage has read: its file and checksum, None for that of the data sheet."""

    file: str
    sha256: str | None = None


class Calibration(OfDataset):
    """The content of `calibration.json`."""

    FILE: ClassVar[str] = "calibration.json"
    stage: Literal["calibrate"]
    version: str
    model: ModelFile = ModelFile(file="data sheet")
    dynamics: str = "slip"
    segments: dict[str, tuple[Segment, ...]]
    stiffness: tuple[Stiffness, ...]
    transfer: tuple[Parameter, ...] = ()
    parameters: tuple[Parameter, ...]
    cannot_tell: tuple[str, ...]
    fit: Fit


class Conditioning(Record):
    """How a measured input was cleaned before it drove the model."""

    method: str
    window_s: float
    noise: float
    unit: str
    reversals: int


class SimulatedRun(Record):
    """What `tsas simulate` says about one run."""

    solver: str = ""
    start: str = ""
    conditioning: dict[str, Conditioning] = {}
    slack_samples: int = 0
    unconverged_samples: int = 0
    channels: dict[str, Channel]


class Simulation(OfDataset):
    """The content of `simulation.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "simulation.json"
    stage: Literal["simulate"]
    version: str
    model: ModelFile
    dynamics: str
    nodes: int | None = None
    own_values_fitted: bool = False
    notes: tuple[str, ...] = ()
    runs: dict[str, SimulatedRun]
    segments: dict[str, tuple[Segment, ...]] = {}


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


class Evidence(Record):
    """How the diagnosis judged."""

    sentence: str = ""


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
