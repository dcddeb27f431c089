"""What `calibration.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.physics.response import Dynamics
from tsas_cli.records.base import Fit, ModelFile, OfDataset, Parameter, Record, Segment


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


class Calibration(OfDataset):
    """The content of `calibration.json`."""

    FILE: ClassVar[str] = "calibration.json"
    stage: Literal["calibrate"]
    version: str
    model: ModelFile = ModelFile(file="data sheet")
    dynamics: Dynamics = "slip"
    segments: dict[str, tuple[Segment, ...]]
    stiffness: tuple[Stiffness, ...]
    transfer: tuple[Parameter, ...] = ()
    parameters: tuple[Parameter, ...]
    cannot_tell: tuple[str, ...]
    fit: Fit
