"""What `drive.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from pydantic import Field

from tsas_cli.records.base import Evidence, Fit, Number, OfDataset, ParameterValue, Record
from tsas_cli.records.diagnosis import HeldOut, NamedCause, RemainingResidual, Verdict

DRIVE_FILE = "drive.toml"  # beside it: the drive, as a feedforward reads it


class BodeCurve(Record):
    """A transfer function over frequency: magnitude [mm per rpm s] and phase."""

    frequency_Hz: tuple[float, ...]
    magnitude: tuple[float, ...]
    phase_deg: tuple[float, ...]


class MeasuredResponse(BodeCurve):
    """The measured transfer function, its coherence, and where the input excites it."""

    coherence: tuple[float, ...]
    excited: tuple[bool, ...]


class FrequencyResponses(Record):
    """Measured and fitted frequency response of a drive."""

    band_Hz: tuple[float, float] | None = None
    measured: MeasuredResponse
    fitted: BodeCurve


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
    """One candidate structure, with its error in times the noise, on held-out data and fitted."""

    name: str
    parameters: int
    held_out_times_noise: Number
    times_noise: Number = None
    converged: bool = True
    chosen: bool = False


class Kinematics(Record):
    """By how much the motor's speed leads x_in: fitted, and by the gear alone."""

    kinematic_gain_mm_per_s_rpm: Number = None
    kinematic_lead_rpm_s_per_mm: Number = None
    fitted_lead_rpm_s_per_mm: float
    fitted_above_kinematic_percent: Number = None


class DriveRunErrors(Record):
    """One run of a drive: its errors and noise in mm."""

    samples: int | None = None
    rate_Hz: Number = None
    noise: Number
    unit: str = "mm"
    rmse: Number
    rmse_nominal: Number
    begins_at_rest: bool | None = None


class DriveCause(NamedCause):
    """An effect that the nominal drive equation lacks; `kind` is that of a lag or a delay."""

    equation: str = Field(default="", exclude=True)
    kind: str = ""


class DriveEvidence(Evidence):
    """How the diagnosis of a drive judged; its runs are those of the file."""

    runs: int = Field(default=0, exclude=True)


class DriveDiagnosis(Record):
    """What the nominal drive equation lacks."""

    verdict: Verdict
    reason: str
    nominal: str = ""
    named: tuple[DriveCause, ...] = ()
    gain_percent: Number = None
    gain_interval_percent: tuple[Number, Number] | None = None
    channels: dict[str, HeldOut] = {}
    remainder: RemainingResidual = RemainingResidual(unexplained=False)
    evidence: DriveEvidence = DriveEvidence()
    next_experiment: str = ""


class DriveFile(OfDataset):
    """The content of `drive.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "drive.json"
    stage: Literal["identify-harmonic-drive"] = "identify-harmonic-drive"
    hold: Literal["zero", "first"] = "first"
    structure: Structure
    structures: tuple[TriedStructure, ...] = ()
    parameters: tuple[ParameterValue, ...]
    kinematics: Kinematics
    inverse: str = ""
    frequency_response: FrequencyResponses
    poles: tuple[Pole, ...] = ()
    runs: dict[str, DriveRunErrors] = {}
    fit: Fit
    diagnosis: DriveDiagnosis
    cannot_tell: tuple[str, ...] = ()
