"""Recordings of drives with something hidden, from the rig that shares no code with the product."""

from dataclasses import replace

import numpy as np

from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.challenge.rig.drive import Drive, Gear, run_drive, run_geared
from tsas_studies.challenge.rig.recordings import Run, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors, measure

RATE_HZ = 500.0
DATA_SHEET = {"turntable_radius_mm": 27.1, "gear_ratio": 120.0}
# So stiff and light, and a motor so quick, that x_in is the motor's angle.
STIFF = Drive(
    inertia_N_mm_s2=1e-3, drive_stiffness_N_per_mm=5e4, damping_N_s_per_mm=0.05, motor_lag_s=1e-6
)
LAGGING = replace(STIFF, motor_lag_s=0.004)
SPRUNG = Drive(motor_lag_s=1e-6)


def speeds(seed=0, duration_s=12.0, to_Hz=60.0, rate_Hz=RATE_HZ):
    """Return time and motor speed of a chirp, of steps and of sines."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration_s * rate_Hz) + 1) / rate_Hz
    growth = np.log(to_Hz / 0.3) / duration_s
    chirp = 1200.0 * np.sin(2.0 * np.pi * 0.3 * np.expm1(growth * t) / growth)
    levels = rng.uniform(-500.0, 500.0, int(duration_s / 0.8) + 1)
    steps = (
        np.interp(t % 0.8, [0.0, 0.02], [0.0, 1.0])
        * np.diff(levels, prepend=0.0)[(t / 0.8).astype(int)]
        + np.concatenate(([0.0], levels[:-1]))[(t / 0.8).astype(int)]
    )
    sines = 500.0 * np.sin(2.0 * t) + 200.0 * np.sin(11.0 * t)
    return {"chirp": (t, chirp), "steps": (t, steps), "sines": (t, sines)}


def columns(drive, gear, time_s, speed, seed):
    clean = (
        run_drive(drive, time_s, speed)
        if gear == Gear()
        else run_geared(drive, gear, time_s, speed)
    )
    rate = 1.0 / (time_s[1] - time_s[0])
    return measure(clean, Sensors(rate_Hz=rate), seed=seed)


def drive_dataset(
    folder, drive=STIFF, gear=None, *, seed=1, data_sheet=None, only=None, bend=None, **options
):
    """Write a dataset of three runs of a drive, or only some, and open it."""
    runs = [
        Run(
            name,
            columns(drive, gear or Gear(), t, u, seed=10 * seed + k),
            {} if bend is None else {"total_bend_rad": bend},
        )
        for k, (name, (t, u)) in enumerate(speeds(seed, **options).items())
        if only is None or name in only
    ]
    write_dataset(folder, runs, data_sheet=DATA_SHEET if data_sheet is None else data_sheet)
    return read_dataset(folder)
