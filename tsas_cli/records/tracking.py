"""What `tracking.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import Field

from tsas_cli.records.base import ModelFile, Record, StageFile

ADAPTIVE = "adaptive-sliding-mode"
Three = tuple[float, float, float]


class Spread(Record):
    """Mean and standard deviation over the seeds; of one seed no spread."""

    mean: float | None
    sd: float | None = None


class Scores(Record):
    """How well the wanted force is followed, and at what cost."""

    rmse_N: Spread
    lowest_error_N: Spread
    highest_error_N: Spread
    outside_percent: Spread
    effort_rpm: Spread
    chatter_rpm_per_s: Spread
    at_limit_percent: Spread

    def __getitem__(self, score: str) -> Spread:
        """Return a score by its name."""
        spread: Spread = getattr(self, score)
        return spread


class Result(Record):
    """One controller under one condition; `run` is the recording of the first seed."""

    controller: str
    condition: str
    run: str
    scores: Scores


class Change(Record):
    """What is changed about the plant, and from when on."""

    quantity: str
    value: float
    from_s: float


class Adaptive(Record):
    """Between which values the estimates are kept."""

    lowest: Three
    highest: Three


class Controllers(Record):
    """The gains, as far as the page shows them."""

    adaptive: Adaptive = Field(alias=ADAPTIVE)


class Sensor(Record):
    """The encoder of x_in."""

    rate_Hz: float = Field(gt=0)
    noise_mm: float
    step_mm: float


class Loop(Record):
    """How rates are estimated."""

    filter_Hz: float = Field(gt=0)


class Settings(Record):
    """The settings of all runs, and the file that they are from."""

    file: str | None = None
    sha256: str | None = None
    sensor: Sensor
    loop: Loop
    controllers: Controllers


class Reference(Record):
    """The wanted force: a shape, or a file and its checksum."""

    shape: str | None = None
    file: str = ""
    sha256: str | None = None


class Tracking(StageFile):
    """The content of `tracking.json`; the runs are the dataset in the same folder."""

    FILE: ClassVar[str] = "tracking.json"
    stage: Literal["track"]
    version: str
    model: ModelFile
    plant: ModelFile
    drive: ModelFile
    dynamics: Literal["slip", "lugre"]
    settings: Settings
    reference: Reference
    gains: str
    seeds: tuple[int, int]
    conditions: dict[str, tuple[Change, ...]]
    results: tuple[Result, ...] = Field(min_length=1)
    notes: tuple[str, ...] = ()
