"""What the stages' files hold, as far as a comparison reads them (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import BaseModel, ConfigDict

from tsas_cli.physics.response import Dynamics


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")


class Source(_Record):
    """The recordings that were read: their dataset, where it was, and which of its runs."""

    name: str
    folder: str = ""
    hashes: dict[str, str]
    chosen: tuple[str, ...] | None = None


class StageJson(_Record):
    """What the stages have in common; `FILE` is the file's name."""

    FILE: ClassVar[str]
    format: Literal[1]
    dataset: Source
    chosen: tuple[str, ...] | None = None


class Fit(_Record):
    """How a fit ended."""

    converged: bool
    message: str = ""


class CalibrationJson(StageJson):
    """The content of `calibration.json`."""

    FILE: ClassVar[str] = "calibration.json"
    stage: Literal["calibrate"]
    dynamics: Dynamics = "slip"
    fit: Fit


class Named(_Record):
    """A cause, and what may be it just as well."""

    effect: str
    rivals: tuple[str, ...] = ()


class HeldOut(_Record):
    """A channel's error on data that no fit has seen, in its unit."""

    unit: str = ""
    rmse_after: float | None
    noise_floor: float | None = None


class DiagnosisJson(StageJson):
    """The content of `diagnosis.json`."""

    FILE: ClassVar[str] = "diagnosis.json"
    stage: Literal["diagnose"]
    verdict: str
    reason: str
    named: tuple[Named, ...] = ()
    channels: dict[str, HeldOut] = {}


class SimulationJson(StageJson):
    """The content of `simulation.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "simulation.json"
    stage: Literal["simulate"]
    dynamics: Dynamics = "slip"
