"""Make the shipped datasets paper-groups and drive-chirp again, byte for byte.

python -m tsas_studies.challenge.rig.make_datasets --out DIR
"""

import argparse
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import tomlkit

from tsas_studies.challenge.rig.drive import Drive, run_drive
from tsas_studies.challenge.rig.motions import Floats, clock, sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensor, Sensors, measure, quantised
from tsas_studies.challenge.rig.tendon import Rig

LICENSE = "Apache-2.0"

# Table 2 of Yang 2025: angular frequency [rad/s], radius of curvature [mm], total bend [rad].
GROUPS = {
    "a": (1.0, 250.0, math.pi),
    "b": (2.0, 250.0, math.pi),
    "c": (1.0, 200.0, math.pi),
    "d": (1.0, 200.0, math.pi / 2.0),
}


RIG = Rig(proximal_length_mm=150.0, distal_length_mm=60.0)
SENSORS = Sensors(
    x_in_mm=Sensor(noise=0.005, step=0.002),
    x_out_mm=Sensor(noise=0.008, step=0.002),
    f_in_N=Sensor(noise=0.1, step=0.01),
    f_out_N=Sensor(noise=0.08, step=0.01),
)
SPEED_STEP_RPM = 0.1


def paper_groups(folder: Path) -> None:
    """Write the four groups of Table 2 with a tendon that also stretches outside the sheath."""
    runs = []
    for seed, (name, (omega, radius, bend)) in enumerate(GROUPS.items(), start=1):
        rig = replace(RIG, total_bend_rad=bend, sheath_length_mm=radius * bend)
        columns = record(rig, sine(omega_rad_s=omega), sensors=SENSORS, seed=seed)
        runs.append(Run(name, columns, conditions(rig)))
    write_dataset(
        folder,
        runs,
        name="paper-groups",
        description="Simulated, not measured: the four groups of Table 2 of Yang et al. 2025 on "
        "an independent virtual rig, with sensor noise and quantisation.",
        license=LICENSE,
    )


def drive_chirp(folder: Path) -> None:
    """Write a chirp, a sine and a validation run of the harmonic drive."""
    runs = []
    for seed, (name, (time_s, wanted_rpm)) in enumerate(speeds().items(), start=11):
        speed = quantised(wanted_rpm, SPEED_STEP_RPM)
        columns = measure(run_drive(Drive(), time_s, speed), SENSORS, seed=seed)
        runs.append(Run(name, columns, {"total_bend_rad": round(math.pi, 6)}))
    write_dataset(
        folder,
        runs,
        name="drive-chirp",
        description="Simulated, not measured: a harmonic drive from motor speed to tendon "
        "displacement, a linear model integrated exactly, with sensor noise and quantisation.",
        license=LICENSE,
        data_sheet={
            "turntable_radius_mm": 27.1,
            "gear_ratio": 120.0,
            "inertia_N_mm_s2": 0.1296,
            "load_stiffness_N_per_mm": 1.579,
            "friction_coefficient": 0.125,
        },
    )


def speeds() -> dict[str, tuple[Floats, Floats]]:
    """Return time [s] and wanted motor speed [rpm] of each run of drive-chirp."""
    chirp, sine_run, check = clock(40.0, 1000.0), clock(15.0, 1000.0), clock(20.0, 1000.0)
    growth = math.log(120.0 / 0.2) / 40.0
    phase = 2.0 * math.pi * 0.2 * np.expm1(growth * chirp) / growth
    pair = 400.0 * np.sin(2.0 * check) + 150.0 * np.sin(13.0 * check)
    ramps = np.interp(check % 5.0, [0.0, 0.05, 1.0, 1.05, 2.5, 2.55, 3.5, 3.55], _RAMP_RPM)
    return {
        "chirp": (chirp, 1500.0 * np.sin(phase)),
        "sine": (sine_run, 420.0 * np.sin(sine_run)),
        "validation": (check, pair + ramps),
    }


_RAMP_RPM = [0.0, 300.0, 300.0, 0.0, 0.0, -300.0, -300.0, 0.0]


def truth() -> dict[str, dict[str, float]]:
    """Return what the rig and the drive were really made of, by dataset."""
    drive = Drive()
    return {
        "paper-groups": {
            **{key: getattr(RIG, key) for key in _TRUE_OF_RIG},
            **noise("x_in_mm", "x_out_mm", "f_in_N", "f_out_N"),
        },
        "drive-chirp": {
            **{key: getattr(drive, key) for key in _TRUE_OF_DRIVE},
            **noise("x_in_mm"),
            "motor_speed_step_rpm": SPEED_STEP_RPM,
        },
    }


_TRUE_OF_RIG = (
    "friction_coefficient",
    "tendon_diameter_mm",
    "tendon_modulus_GPa",
    "preload_N",
    "load_stiffness_N_per_mm",
    "proximal_length_mm",
    "distal_length_mm",
    "presliding_length_mm",
)
_TRUE_OF_DRIVE = tuple(Drive.__dataclass_fields__)


def noise(*columns: str) -> dict[str, float]:
    """Return the standard deviation of the noise and the step of each column."""
    sensors = {column: getattr(SENSORS, column) for column in columns}
    return {f"noise_{column}": sensor.noise for column, sensor in sensors.items()} | {
        f"step_{column}": sensor.step for column, sensor in sensors.items()
    }


def make(out: Path) -> None:
    """Write both datasets, each with its truth.toml, into a folder."""
    paper_groups(out / "paper-groups")
    drive_chirp(out / "drive-chirp")
    for name, values in truth().items():
        (out / name / "truth.toml").write_text(tomlkit.dumps(values), encoding="utf-8")


def main() -> None:
    """Read --out and make the datasets."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    make(parser.parse_args().out)


if __name__ == "__main__":
    main()
