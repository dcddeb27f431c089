"""What `closing.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import Field

from tsas_cli.records.base import Record, StageFile
from tsas_cli.records.tracking import Scores, Spread, StatedSettings

HIDDEN = "hidden"  # name of the case that hides what a user asks for


class Rmse(Spread):
    """Mean and standard deviation over the seeds [N]; of one seed no spread."""

    mean: float = Field(gt=0)


class ClosedScores(Scores):
    """How well the wanted force is followed with one model."""

    rmse_N: Rmse


class Models(Record):
    """The scores of one controller with each model in its inverse and feedforward."""

    data_sheet: ClosedScores = Field(alias="data sheet")
    calibrated: ClosedScores
    extended: ClosedScores
    true: ClosedScores


class Row(Record):
    """One controller of a case; `over_limit` is the RMSE with the extended over the true model."""

    controller: str
    models: Models
    over_limit: float

    @property
    def by_model(self) -> dict[str, Rmse]:
        """The RMSE by the model's role in plots, from the poorest to the limit."""
        models = self.models
        return {
            "data-sheet": models.data_sheet.rmse_N,
            "calibrated": models.calibrated.rmse_N,
            "extended": models.extended.rmse_N,
            "true": models.true.rmse_N,
        }

    @property
    def gain(self) -> float:
        """By which factor the extended model lowers the RMSE of the data sheet's."""
        return self.models.data_sheet.rmse_N.mean / self.models.extended.rmse_N.mean


class Named(Record):
    """An effect that the diagnosis names; `rivals` are those that may be it just as well."""

    effect: str
    rivals: tuple[str, ...] = ()


class ClosedCase(Record):
    """What was hidden in the plant, what was named, and how each controller tracks then."""

    case: str
    title: str
    hidden: dict[str, float]
    verdict: str
    reason: str = ""
    named: tuple[Named, ...]
    controllers: tuple[Row, ...] = Field(min_length=1)


class ClosedSettings(StatedSettings):
    """The settings of all runs, whole: they stand for the file that they were read from."""

    file: str | None = Field(default=None, exclude=True)
    sha256: str | None = Field(default=None, exclude=True)


class ClosingFile(StageFile):
    """The content of `closing.json`; each case's dataset and diagnosis lie in a folder below."""

    FILE: ClassVar[str] = "closing.json"
    stage: Literal["close-loop"] = "close-loop"
    settings: ClosedSettings
    seeds: tuple[int, int]
    cases: tuple[ClosedCase, ...] = Field(min_length=1)

    def of_controllers(self) -> dict[str, dict[str, Row]]:
        """Return the rows by controller, and of each by case."""
        found: dict[str, dict[str, Row]] = {}
        for case in self.cases:
            for row in case.controllers:
                found.setdefault(row.controller, {})[case.case] = row
        return found
