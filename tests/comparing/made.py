"""Recordings of the independent rig, calibrated, for the tests of comparisons."""

from dataclasses import replace
from functools import cache

from tsas_cli.stages.calibrate import calibrate
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

NOMINAL = Rig(cells=60)
ROUGH = replace(NOMINAL, friction_coefficient=0.15)
SENSORS = Sensors(rate_Hz=200.0)
PACES = {"slow": 1.0, "fast": 2.0}  # rad/s


@cache
def clean(rig, omega):
    return simulate(rig, sine(omega_rad_s=omega, rate_Hz=200.0))


def recorded(folder, rig, *, seed, name="bench"):
    """Write a dataset of two runs; the seed is of their noise."""
    runs = [
        Run(run, measure(clean(rig, omega), SENSORS, seed=10 * seed + k), conditions(rig))
        for k, (run, omega) in enumerate(PACES.items())
    ]
    return write_dataset(folder, runs, name=name)


def calibrated(root, rig, *, seed):
    """Record and calibrate; return the folder of the calibration, the dataset beside it."""
    dataset = recorded(root / f"data-{seed}", rig, seed=seed)
    calibrate(dataset, out=root / f"calibrated-{seed}")
    return root / f"calibrated-{seed}"
