"""`drive.toml`: an identified drive, written and read."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import tomlkit
from pydantic import Field

from tsas_cli.identification.estimate import Estimate, StoredValue, check_value
from tsas_cli.recordings.manifest import read_toml
from tsas_cli.recordings.validation import parse
from tsas_cli.records.drive import DRIVE_FILE
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.plausible import Range
from tsas_cli.support.strict_table import StrictTable

RANGES = {
    "gain_mm_per_s_rpm": Range(1e-9, 1e6, "mm/(s rpm)"),
    "motor_lag_s": Range(1e-9, 1e3, "s", or_zero=True),
    "delay_s": Range(1e-9, 1e3, "s", or_zero=True),
    "leak_per_s": Range(1e-9, 1e6, "1/s", or_zero=True),
    "natural_frequency_Hz": Range(1e-6, 1e9, "Hz"),
    "damping_ratio": Range(1e-9, 1e6),
    "sine_mm": Range(-1e6, 1e6, "mm"),
    "cosine_mm": Range(-1e6, 1e6, "mm"),
    "play_mm": Range(1e-9, 1e6, "mm", or_zero=True),
    "kV_rpm_s_per_mm": Range(1e-6, 1e9, "rpm s/mm"),
    "kA_rpm_s2_per_mm": Range(1e-12, 1e9, "rpm s²/mm", or_zero=True),
    "damping_N_s_per_mm": Range(-1e9, 1e9, "N s/mm"),
    "drive_stiffness_N_per_mm": Range(1e-9, 1e12, "N/mm"),
    "whole_stiffness_N_per_mm": Range(-1e12, 1e12, "N/mm"),
    "pull_back_N_per_mm": Range(-1e12, 1e12, "N/mm"),
    "compliance_mm_per_N": Range(-1e9, 1e9, "mm/N"),
    "turntable_radius_mm": Range(1e-4, 1e6, "mm"),
    "gear_ratio": Range(1e-3, 1e6),
    "inertia_N_mm_s2": Range(1e-9, 1e9, "N mm s²"),
}
UNITS = {name: allowed.unit for name, allowed in RANGES.items()}


@dataclass(frozen=True)
class IdentifiedDrive:
    """G(s) = K e^{−Ts} / ((s + a)(τs + 1)(s²/ω² + 2ζs/ω + 1)) from rpm to mm, and what follows.

    A lag, a delay, a leak, a play or a ripple that was not found is 0; None is what the drive does
    not show (a stiff drive has no natural frequency) or the data sheet would have to tell (J).
    """

    gain_mm_per_s_rpm: float
    kV_rpm_s_per_mm: float
    kA_rpm_s2_per_mm: float = 0.0
    motor_lag_s: float = 0.0
    delay_s: float = 0.0
    leak_per_s: float = 0.0
    natural_frequency_Hz: float | None = None
    damping_ratio: float | None = None
    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    play_mm: float = 0.0
    inertia_N_mm_s2: float | None = None
    damping_N_s_per_mm: float | None = None
    drive_stiffness_N_per_mm: float | None = None
    pull_back_N_per_mm: float | None = None
    turntable_radius_mm: float | None = None
    gear_ratio: float | None = None


class _Structure(StrictTable):
    name: str
    hold: Literal["zero", "first"] = "first"


class _DriveTables(StrictTable):
    format: Literal[1]
    kind: Literal["drive"]
    version: str = ""
    dataset: dict[str, object] = Field(default_factory=dict)
    structure: _Structure
    parameters: dict[str, StoredValue]


def write_drive(
    path: Path,
    estimates: Mapping[str, Estimate],
    structure: Mapping[str, str],
    *,
    version: str,
    dataset: Mapping[str, object],
) -> None:
    """Write `drive.toml`."""
    content = {
        "format": 1,
        "kind": "drive",
        "version": version,
        "dataset": dict(dataset),
        "structure": dict(structure),
        "parameters": {
            name: {
                key: value
                for key, value in asdict(e).items()
                if key not in ("name", "run")
                and value is not None
                and (not isinstance(value, float) or math.isfinite(value))
            }
            for name, e in estimates.items()
        },
    }
    path.write_text(tomlkit.dumps(content), encoding="utf-8")


def read_drive(path: Path) -> IdentifiedDrive:
    """Read `drive.toml`, or the folder that holds it.

    InputError: the file is missing, not TOML, of another format or kind, names an unknown
    parameter, lacks the gain, or a value or its unit is not what it has to be.
    """
    path = path / DRIVE_FILE if path.is_dir() else path
    file = parse(_DriveTables, read_toml(path), path)
    for name, value in file.parameters.items():
        _check(name, value, path)
    values = {name: value.value for name, value in file.parameters.items()}
    if "gain_mm_per_s_rpm" not in values:
        raise InputError(
            "parameters.gain_mm_per_s_rpm is missing",
            where=path,
            expected="what `tsas identify-harmonic-drive` writes",
        )
    values.setdefault("kV_rpm_s_per_mm", 1.0 / values["gain_mm_per_s_rpm"])
    return drive_of(values)


def checked_drive(drive: IdentifiedDrive) -> IdentifiedDrive:
    """Return a drive in memory whose values can be.

    InputError: as from `read_drive`.
    """
    where = "the drive in memory"
    for name, value in vars(drive).items():
        if value is not None:
            content = {"value": value, "unit": UNITS[name]}
            _check(name, parse(StoredValue, content, f"{where}, {name}"), where)
    return drive


def drive_of(values: Mapping[str, float]) -> IdentifiedDrive:
    """Return a drive by its values, of which those that are no property of a drive are left out."""
    known = IdentifiedDrive.__dataclass_fields__
    return IdentifiedDrive(**{name: value for name, value in values.items() if name in known})


def _check(name: str, value: StoredValue, path: object) -> None:
    if name not in RANGES:
        raise InputError(f"unknown parameter {name}", where=path, remedy=nearest(name, RANGES))
    check_value(name, value, RANGES[name], path)
