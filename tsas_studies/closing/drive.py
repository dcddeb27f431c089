"""The drive's case of `tsas close-loop`: a gear that winds up, where the paper's drive is stiff.

A spring takes the tendon's place and the motor is driven by itself, with a chirp and with sines.
The drive is identified from that, and feeds forward in four ways: by the data sheet's kinematics,
by the fitted kV and kA alone (Yang 2025, Eq. 51), with its stiffness, and as the plant's own.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa

from tsas_cli.controllers.closed_loop import (
    X_SEEN,
    DriveSensor,
    LoopPlant,
    LoopReference,
    close_loop,
    plant_at_rest,
)
from tsas_cli.controllers.pid import Pid
from tsas_cli.controllers.signals import error_filter
from tsas_cli.drive.file import read_drive
from tsas_cli.physics.plant.laws import plant_laws
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.support.arrays import Floats
from tsas_cli.tracking.recorded import manifest
from tsas_cli.tracking.settings import Settings, actuator_of

CHIRP_S, CHIRP_RPM, FIRST_HZ, LAST_HZ = 40.0, 1500.0, 0.2, 120.0
SINES_S, SINES = 20.0, ((400.0, 2.0), (150.0, 13.0))  # rpm, rad/s
PRELOAD_N, STIFF_N = 200.0, 1e7  # so that the spring never hangs loose and nothing else gives
NODES = 2
SUBSTEPS = 64  # BDF2 lowers the resonance by (ωh)²/3: by 0.6 % with 4, by 2e-5 with these


def spring_alone(settings: Settings) -> Settings:
    """Return the settings of a rig with the load's spring at the drive, no tendon and no bend."""
    changed = {"friction_coefficient": 0.0, "total_bend_rad": 0.0, "preload_N": PRELOAD_N}
    return settings.model_copy(update={"rig": settings.rig.model_copy(update=changed)})


def record_drive(settings: Settings, folder: Path) -> None:
    """Drive the motor by itself and write speed and x_in as a dataset."""
    bench = spring_alone(settings)
    chirp, sines = _clock(CHIRP_S, bench), _clock(SINES_S, bench)
    growth = math.log(LAST_HZ / FIRST_HZ) / CHIRP_S
    phase = 2.0 * math.pi * FIRST_HZ * np.expm1(growth * chirp) / growth
    speeds = {
        "chirp": (chirp, CHIRP_RPM * np.sin(phase)),
        "sines": (sines, sum(rpm * np.sin(w * sines) for rpm, w in SINES)),
    }
    tables = {}
    for seed, (name, (time_s, rpm)) in enumerate(speeds.items(), start=111):
        x_in = driven(np.asarray(rpm), bench, seed)
        tables[name] = pa.table({"time_s": time_s, "motor_speed_rpm": rpm, "x_in_mm": x_in})
    folder.mkdir(parents=True)
    write_dataset(folder, manifest(tables, bench), tables)


def driven(rpm: Floats, bench: Settings, seed: int) -> Floats:
    """Return what the encoder reads of x_in, shape (m,), while the motor is asked for speeds."""
    drive, m = bench.drive.actuator(), rpm.size
    rig = Rig(
        friction_coefficient=0.0,
        tendon_stiffness_N=STIFF_N,
        load_stiffness_N_per_mm=bench.rig.load_stiffness_N_per_mm,
        sheath_length_mm=bench.rig.sheath_length_mm,
        total_bend_rad=0.0,
        preload_N=PRELOAD_N,
    )
    noise = bench.sensor.noise_mm * np.random.default_rng(seed).standard_normal(m)
    A, b = error_filter(bench.loop.filter_Hz, bench.step_s)
    columns, _, _ = close_loop(
        LoopReference(np.zeros((4, m)), rpm),
        DriveSensor(bench.step_s, noise, bench.sensor.step_mm, A, b),
        bench.controllers.laws("pid", drive.gain_mm_per_s_rpm)._replace(pid=Pid(0.0, 0.0, 0.0)),
        LoopPlant(
            actuator=drive,
            rigs=(rig, rig),
            laws=(plant_laws(rig), plant_laws(rig)),
            change_at=-1,
            substeps=SUBSTEPS,
            nodes=NODES,
            start=plant_at_rest(0.0, rig, drive, NODES),
        ),
    )
    seen: Floats = columns[X_SEEN]
    return seen


def known_drives(identified: Path, settings: Settings) -> tuple[Actuator, ...]:
    """Return the drives of the feedforward, by the models of `closing.MODELS`."""
    drive, limit_rpm = read_drive(identified), settings.drive.speed_limit_rpm
    return (
        settings.drive.kinematic(),
        actuator_of(replace(drive, drive_stiffness_N_per_mm=None), limit_rpm),
        actuator_of(drive, limit_rpm),
        settings.drive.actuator(),
    )


def _clock(duration_s: float, settings: Settings) -> Floats:
    return np.arange(round(duration_s / settings.step_s), dtype=np.float64) * settings.step_s
