"""What the stages' JSON files have in common, as far as they are read (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import BaseModel, ConfigDict


class Record(BaseModel):
    """What a stage has written down, as far as the page reads it."""

    # The stages may say more than the page shows.
    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)


class Source(Record):
    """The recordings that were read: their dataset, where it was, and which of its runs.

    `folder` is relative to that of the file; `chosen` are the runs, None where it is all;
    `conditions` what was said of them in place of the manifest's.
    """

    name: str
    folder: str = ""
    hashes: dict[str, str]
    chosen: tuple[str, ...] | None = None
    conditions: dict[str, float] = {}


class StageFile(Record):
    """What all stages say; `FILE` is the file's name."""

    FILE: ClassVar[str]
    format: Literal[1]


class OfDataset(StageFile):
    """What a stage says that has read a dataset; `chosen` and `conditions` as of `Source`."""

    dataset: Source
    chosen: tuple[str, ...] | None = None
    conditions: dict[str, float] = {}


class ModelFile(Record):
    """The model that a stage has read: its file and checksum, None for that of the data sheet."""

    file: str
    sha256: str | None = None


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


class Fit(Record):
    """How the joint fit ended."""

    converged: bool
    message: str = ""


class Evidence(Record):
    """How the diagnosis judged."""

    sentence: str = ""
