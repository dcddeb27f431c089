"""What `tracking.json` holds (docs/formats.md)."""

from collections.abc import Callable
from typing import ClassVar, Literal

from pydantic import ConfigDict, Field

from tsas_cli.records.base import ModelFile, Number, Record, StageFile, number_text

ADAPTIVE = "adaptive-sliding-mode"
SCORE_TITLES = {
    "rmse_N": "RMSE [N]",
    "lowest_error_N": "lowest [N]",
    "highest_error_N": "highest [N]",
    "effort_rpm": "effort [rpm]",
    "chatter_rpm_per_s": "chatter [rpm/s]",
    "outside_percent": "outside 2 % [%]",
}
Three = tuple[float, float, float]


class Spread(Record):
    """Mean and standard deviation over the seeds; of one seed no spread."""

    mean: Number
    sd: Number = None

    def text(self) -> str:
        """Return mean and spread for a printed table."""
        if self.mean is None:
            return ""
        return f"{self.mean:.4g}" + ("" if self.sd is None else f" ± {self.sd:.2g}")


class Scores(Record):
    """How well the wanted force is followed, and at what cost."""

    rmse_N: Spread
    lowest_error_N: Spread
    highest_error_N: Spread
    effort_rpm: Spread
    chatter_rpm_per_s: Spread
    outside_percent: Spread
    at_limit_percent: Spread

    def __getitem__(self, score: str) -> Spread:
        """Return a score by its name."""
        spread: Spread = getattr(self, score)
        return spread


class TrackedResult(Record):
    """One controller under one condition; `run` is the recording of the first seed."""

    controller: str
    condition: str
    run: str
    scores: Scores
    printed_rmse_N: Number = None
    relay: bool = False
    unsettled_steps: int = 0


class ConditionChange(Record):
    """What is changed about the plant, and from when on."""

    quantity: str
    value: float
    from_s: float


class Stated(Record):
    """A table of the settings, whole: what pages read has a field, the rest is kept as it is."""

    model_config = ConfigDict(extra="allow")


class Adaptive(Stated):
    """Between which values the estimates are kept."""

    lowest: Three
    highest: Three


class Controllers(Stated):
    """The gains."""

    pid: dict[str, float] = {}
    sliding: dict[str, float | Three] = Field(default={}, alias="sliding-mode")
    adaptive: Adaptive = Field(alias=ADAPTIVE)


class Sensor(Stated):
    """The encoder of x_in."""

    rate_Hz: float = Field(gt=0)
    noise_mm: float
    step_mm: float


class Loop(Stated):
    """How rates are estimated."""

    filter_Hz: float = Field(gt=0)


class StatedSettings(Stated):
    """The settings of all runs (docs/tracking.md), and the file that they are from."""

    file: str | None = None
    sha256: str | None = None
    format: Literal[1] = 1
    rig: dict[str, float] = {}
    drive: dict[str, float] = {}
    reference: dict[str, float] = {}
    sensor: Sensor
    loop: Loop
    controllers: Controllers


class Reference(ModelFile):
    """The wanted force: a shape, or a file and its checksum."""

    SPARSE = ModelFile.SPARSE | {"shape", "file"}
    shape: str | None = None
    file: str = ""


class TrackingFile(StageFile):
    """The content of `tracking.json`; the runs are the dataset in the same folder."""

    FILE: ClassVar[str] = "tracking.json"
    stage: Literal["track"] = "track"
    model: ModelFile
    plant: ModelFile
    drive: ModelFile
    settings: StatedSettings
    reference: Reference
    dynamics: Literal["slip", "lugre"]
    gains: str
    seeds: tuple[int, int]
    conditions: dict[str, tuple[ConditionChange, ...]]
    results: tuple[TrackedResult, ...] = Field(min_length=1)
    notes: tuple[str, ...] = ()

    def scores(self, shown: Callable[[Spread], str]) -> tuple[list[str], list[list[str]]]:
        """Return header and rows of the scores, beside the RMSE of the paper where it applies.

        `shown` makes the text of a score.
        """
        header = ["controller", "condition", *SCORE_TITLES.values()]
        rows = [
            [row.controller, row.condition, *(shown(row.scores[score]) for score in SCORE_TITLES)]
            for row in self.results
        ]
        if any(row.printed_rmse_N is not None for row in self.results):
            header.insert(3, "Table 5 [N]")
            for cells, row in zip(rows, self.results, strict=True):
                cells.insert(3, number_text(row.printed_rmse_N, "g"))
        return header, rows
