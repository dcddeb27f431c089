"""What `calibration.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.physics.response import Dynamics
from tsas_cli.records.base import (
    Fit,
    ModelFile,
    Number,
    OfDataset,
    ParameterValue,
    PhaseSegment,
    Record,
)

MODEL_FILE = "model.toml"  # beside it, and beside a simulation: the model that was used


class Stiffness(Record):
    """One phase of one run: its stiffness measured, by theory, and of the calibrated model."""

    run: str
    phase: str
    km: ParameterValue
    kr: ParameterValue | None = None
    theory_N_per_mm: Number = None
    theory_elastic_N_per_mm: Number = None
    expected_N_per_mm: Number = None
    occurrences: int
    samples: int | None = None
    note: str | None = None


class NominalFit(Fit):
    """How the joint fit of the nominal parameters ended, and the solvers of the simulation."""

    solver: tuple[str, ...] | str = ()


class ChannelError(Record):
    """RMS of the residual and noise level of a channel, in its unit."""

    rmse: Number
    noise: Number


class CalibrationFile(OfDataset):
    """The content of `calibration.json`."""

    FILE: ClassVar[str] = "calibration.json"
    stage: Literal["calibrate"] = "calibrate"
    model: ModelFile = ModelFile(file="data sheet")
    dynamics: Dynamics = "slip"
    segments: dict[str, tuple[PhaseSegment, ...]]
    stiffness: tuple[Stiffness, ...]
    transfer: tuple[ParameterValue, ...] = ()
    parameters: tuple[ParameterValue, ...]
    cannot_tell: tuple[str, ...]
    fit: NominalFit
    channels: dict[str, dict[str, ChannelError]] = {}
