"""What `plan.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.records.base import DatasetSource, Number, Record, StageFile


class EffectSize(Record):
    """From which size on one parameter of an effect is found and named; None where it is not.

    `shape` holds what else of the effect is taken as given.
    """

    effect: str
    parameter: str
    unit: str
    shape: dict[str, float]
    found_from: Number
    named_from: Number
    nearest: str | None = None
    hidden_in: tuple[str, ...] = ()


class ProposedRun(Record):
    """A run that might be added, as a rig file holds it."""

    SPARSE = frozenset({"speed_mm_per_s", "frequency_Hz"})
    sheath_length_mm: float
    total_bend_rad: float
    preload_N: float
    motion: str
    amplitude_mm: float
    speed_mm_per_s: float | None = None
    frequency_Hz: float | None = None
    periods: int
    dwell_s: float


class SmallerSize(Record):
    """From which size on an effect is named, before a run is added and with it."""

    effect: str
    parameter: str
    unit: str
    named_from: Number
    named_from_with_it: Number


class RunProposal(Record):
    """A further run, by how much it lowers the sizes on average, and what it improves."""

    run: ProposedRun
    sentence: str
    falls_percent: float
    better: tuple[SmallerSize, ...]


class RigSource(Record):
    """The rig file that was read."""

    name: str
    file: str
    sha256: str


class RunPlan(StageFile):
    """The content of `plan.json`, of a dataset or of a rig file."""

    SPARSE = DatasetSource.SPARSE | {"dataset", "rig"}
    FILE: ClassVar[str] = "plan.json"
    stage: Literal["plan"] = "plan"
    dataset: DatasetSource | None = None
    chosen: tuple[str, ...] | None = None
    conditions: dict[str, float] = {}
    rig: RigSource | None = None
    effects: tuple[EffectSize, ...]
    groups: tuple[tuple[str, str], ...]
    proposals: tuple[RunProposal, ...]
    cannot_tell: tuple[str, ...] = ()
