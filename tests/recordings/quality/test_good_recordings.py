"""Ordinary recordings are left in peace: no error and no warning."""

import dataclasses
from itertools import product

import pytest

from tests.recordings.quality.bench import LOAD, Bench, columns, trial
from tsas_cli.recordings.quality import RUN_CHECKS
from tsas_cli.recordings.quality.finding import Remark

SHAPES = ("sine", "triangle", "chirp", "dwells", "nested", "decaying")
LOADS = ("spring", "force", "displacement")


def complaints(measured, load):
    subject = trial(measured, {"load_stiffness_N_per_mm": LOAD}, load)
    return [
        (check.code, said.sentence)
        for check in RUN_CHECKS
        if all(name in subject.channels for name in check.needs)
        for said in check.find(subject)
        if isinstance(said, Remark) and said.severity != "note"
    ]


@pytest.mark.parametrize(("shape", "load"), list(product(SHAPES, LOADS)))
@pytest.mark.parametrize(
    "sensors",
    [
        {"rate_Hz": 100.0, "noise_mm": 0.02, "noise_N": 0.3},
        {"rate_Hz": 500.0, "noise_mm": 0.005, "noise_N": 0.05, "step_mm": 0.01, "step_N": 0.05},
        {"rate_Hz": 500.0, "noise_mm": 0.0, "noise_N": 0.1, "step_mm": 0.02, "step_N": 0.005},
        {"rate_Hz": 200.0, "noise_mm": 0.0, "noise_N": 0.0},
        {"rate_Hz": 2000.0, "noise_mm": 0.01, "noise_N": 0.1, "step_mm": 0.002, "step_N": 0.01},
    ],
    ids=["noisy", "dithered", "encoder", "noiseless", "fast"],
)
def test_nothing_is_said_about_an_ordinary_recording(shape, load, sensors):
    bench = Bench(shape=shape, load=load, seed=7, **sensors)
    assert complaints(columns(bench), load) == []


@pytest.mark.parametrize("shape", SHAPES)
def test_nothing_is_said_where_only_the_drive_is_recorded(shape):
    for seed in range(3):
        measured = columns(Bench(shape=shape, seed=seed))
        drive = {name: measured[name] for name in ("time_s", "x_in_mm", "f_in_N")}
        assert complaints(drive, "spring") == []


def test_nothing_is_said_in_twenty_repeats_of_one_experiment():
    bench = Bench(rate_Hz=500.0, noise_mm=0.02, noise_N=0.3, step_mm=0.01, step_N=0.05)
    for seed in range(20):
        assert complaints(columns(dataclasses.replace(bench, seed=seed)), "spring") == []
