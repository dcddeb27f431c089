"""The file that describes a rig and its planned runs, before any recording."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from tsas_cli.diagnosis.motions import PEAK, Kind
from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.recordings.manifest import RigSheet, RunId, read_toml
from tsas_cli.recordings.validation import parse
from tsas_cli.support.errors import InputError
from tsas_cli.support.plausible import (
    Bend,
    Displacement,
    Duration,
    Frequency,
    Length,
    NoiseMm,
    SampleRate,
    Speed,
    Tension,
    plausible,
)
from tsas_cli.support.strict_table import StrictTable

MOST_SAMPLES = 1_000_000  # of a run
_ForceNoise = Annotated[float, plausible(1e-9, 1e6, "N")]


class Sensors(StrictTable):
    """The sample rate, and the noise level of each channel; None: not recorded."""

    rate_Hz: SampleRate
    x_in_mm: NoiseMm
    x_out_mm: Annotated[float, plausible(1e-9, 1e3, "mm")] | None = None
    f_in_N: _ForceNoise | None = None
    f_out_N: _ForceNoise | None = None

    @model_validator(mode="after")
    def _measures(self) -> "Sensors":
        if not self.outputs:
            raise ValueError(f"one of {', '.join(CHANNELS)} is needed besides x_in_mm")
        return self

    @property
    def outputs(self) -> dict[str, float]:
        """The noise level of each recorded channel except the drive."""
        noise = {name: getattr(self, name) for name in CHANNELS}
        return {name: sd for name, sd in noise.items() if sd is not None}


class PlannedRun(StrictTable):
    """One run: its conditions and its motion."""

    id: RunId
    sheath_length_mm: Length
    total_bend_rad: Bend
    preload_N: Tension
    motion: Kind
    amplitude_mm: Displacement
    speed_mm_per_s: Speed | None = None
    frequency_Hz: Frequency | None = None
    periods: int = Field(default=2, ge=1, le=10_000)
    dwell_s: Duration = 0.0

    @model_validator(mode="after")
    def _one_speed(self) -> "PlannedRun":
        if self.speed_mm_per_s is None and self.frequency_Hz is None:
            raise ValueError("one of speed_mm_per_s and frequency_Hz is needed")
        if self.speed_mm_per_s is not None and self.frequency_Hz is not None:
            raise ValueError("only one of speed_mm_per_s and frequency_Hz may be given")
        if self.frequency_Hz is not None and self.motion not in PEAK:
            raise ValueError(f"{self.motion} needs speed_mm_per_s, not frequency_Hz")
        if self.dwell_s > 0.0 and self.motion == "chirp":
            raise ValueError("a chirp has no dwell_s")
        return self

    @property
    def speed(self) -> float:
        """The highest speed [mm/s]."""
        if self.speed_mm_per_s is not None:
            return self.speed_mm_per_s
        return PEAK[self.motion] * self.amplitude_mm * (self.frequency_Hz or 0.0)


class Limits(StrictTable):
    """Limits of the rig; by default those of the planned runs."""

    amplitude_mm: Displacement | None = None
    speed_mm_per_s: Speed | None = None
    preload_N: tuple[Tension, ...] = ()
    total_bend_rad: tuple[Bend, ...] = ()

    @field_validator("preload_N", "total_bend_rad")
    @classmethod
    def _rise(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if any(b <= a for a, b in pairwise(values)):
            listed = ", ".join(f"{value:g}" for value in values)
            raise ValueError(f"expected values that increase, from the lowest on, got {listed}")
        return values


class RigFile(StrictTable):
    """The whole file."""

    format: Literal[1]
    kind: Literal["plan"]
    name: str = Field(min_length=1)
    rig: RigSheet = RigSheet()
    sensors: Sensors
    limits: Limits = Limits()
    run: tuple[PlannedRun, ...] = Field(min_length=1)


def read_rig_file(path: Path) -> RigFile:
    """Return the content of a file of planned runs, checked.

    InputError: it is missing, not TOML, or violates the format.
    """
    file = parse(RigFile, read_toml(path), path)
    for key, hint in file.rig.unknown_keys().items():
        raise InputError(f"unknown key rig.{key}", where=path, remedy=hint)
    ids = [run.id for run in file.run]
    duplicates = [i for i in ids if ids.count(i) > 1]
    if duplicates:
        raise InputError(f"duplicate run id {duplicates[0]!r}", where=path)
    return file
