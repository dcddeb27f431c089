"""What `drive.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import Field

from tsas_cli.records.base import Evidence, Fit, OfDataset, Parameter, Record
from tsas_cli.records.diagnosis import Cause, HeldOut


class Curve(Record):
    """A transfer function over frequency: magnitude [mm per rpm s] and phase."""

    frequency_Hz: tuple[float, ...]
    magnitude: tuple[float, ...]
    phase_deg: tuple[float, ...]


class MeasuredResponse(Curve):
    """The measured one, with its coherence and where the input tells it."""

    coherence: tuple[float, ...]
    excited: tuple[bool, ...]


class Response(Record):
    """Measured and fitted frequency response of a drive."""

    band_Hz: tuple[float, float] | None = None
    measured: MeasuredResponse
    fitted: Curve


class Pole(Record):
    """A pole of a drive's transfer function, or 1/delay, and whether the input shows it."""

    kind: str
    real_per_s: float
    imaginary_per_s: float
    frequency_Hz: float
    in_band: bool


class Structure(Record):
    """The transfer function that was chosen."""

    name: str
    equation: str


class TriedStructure(Record):
    """One candidate structure, with its error on held-out data in times the noise."""

    name: str
    parameters: int
    held_out_times_noise: float | None
    converged: bool = True
    chosen: bool = False


class Kinematics(Record):
    """By how much the motor's speed leads x_in: fitted, and by the gear alone."""

    fitted_lead_rpm_s_per_mm: float
    kinematic_lead_rpm_s_per_mm: float | None = None


class DriveRun(Record):
    """One run of a drive: its errors and noise in mm."""

    rmse: float | None
    rmse_nominal: float | None
    noise: float | None


class DriveDiagnosis(Record):
    """What the nominal drive equation lacks."""

    verdict: Literal["named", "ambiguous", "sufficient", "unexplained", "undecided"]
    reason: str
    named: tuple[Cause, ...] = ()
    channels: dict[str, HeldOut] = Field(default_factory=dict)
    evidence: Evidence = Evidence()
    next_experiment: str = ""


class Drive(OfDataset):
    """The content of `drive.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "drive.json"
    stage: Literal["identify-harmonic-drive"]
    version: str
    hold: Literal["zero", "first"] = "first"
    structure: Structure
    structures: tuple[TriedStructure, ...] = ()
    parameters: tuple[Parameter, ...]
    kinematics: Kinematics
    inverse: str = ""
    frequency_response: Response
    poles: tuple[Pole, ...] = ()
    runs: dict[str, DriveRun] = Field(default_factory=dict)
    fit: Fit
    diagnosis: DriveDiagnosis
    cannot_tell: tuple[str, ...] = ()
