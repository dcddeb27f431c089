"""What counts in the fit, and how much: weights near reversals, samples near the ends."""

import gc
import weakref

import numpy as np
import pytest

from tests.identification.recorded import manifest, prepared
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.run_errors import run_errors
from tsas_cli.identification.samples import kept_samples
from tsas_studies.challenge.rig.motions import Motion, nested, sine, triangle, two_sines
from tsas_studies.challenge.rig.sensors import Sensor, Sensors
from tsas_studies.challenge.rig.tendon import Rig


def errors_of(run):
    rig = data_sheet(manifest(run)).rig(run.run)
    return run_errors(run, kept_samples(run, rig), rig), rig


@pytest.mark.parametrize("motion", [sine(), triangle()], ids=["sine", "triangle"])
def test_the_tension_is_uncertain_after_a_reversal_and_sure_in_slip(motion):
    """A turning point off by a micrometre moves the tension after it by newtons."""
    run = prepared(Rig(), motion)
    errors, _ = errors_of(run)
    weights = errors.weights["f_in_N"] / run.noise["f_in_N"]
    turn = int(run.conditioned["x_in_mm"].reversals[1])
    assert weights[turn + 1 : turn + 6].max() > 4.0
    assert weights[turn - 1500 : turn - 500].max() < 1.05


@pytest.mark.parametrize("motion", [sine(), nested()], ids=["sine", "nested"])
def test_a_true_model_s_errors_are_about_one(motion):
    run = prepared(Rig(), motion, seed=3)
    errors, rig = errors_of(run)
    for found in errors.errors(rig).values():
        assert np.sqrt(np.mean(found**2)) < 1.3


def test_a_reversal_too_near_the_end_to_be_seen_is_left_out():
    """This motion turns back 24 ms before its end, by less than twice the noise."""
    motion = two_sines()
    last_turn = int(np.flatnonzero(np.diff(np.sign(np.diff(motion.x_in_mm))))[-1]) + 1
    assert motion.time_s.size - last_turn < 50
    run = prepared(Rig(), motion, sensors=Sensors(x_in_mm=Sensor(0.02), f_in_N=Sensor(0.1)))
    errors, _ = errors_of(run)
    assert errors.samples["f_in_N"].max() < last_turn


def stroke_with_a_short_turn(depth_mm=0.012):
    """A slow sine that stops half way and turns back by about the noise, for 40 ms."""
    time_s = np.arange(0.0, 13.0, 1e-3)
    phase = 2.0 * time_s
    stroke = 10.0 * (1.0 - np.cos(phase)) * (0.75 + 0.25 * np.cos(phase / 2.6))
    x_in = stroke + 1.2 * np.sin(3.7 * phase) ** 2
    turns = np.flatnonzero(np.diff(np.sign(np.diff(x_in)))) + 1
    assert np.min(np.abs(np.diff(x_in[turns]))) == pytest.approx(depth_mm, rel=0.05)
    return Motion(time_s, x_in)


@pytest.mark.parametrize("seed", [0, 2, 3, 5])
def test_a_reversal_taken_for_noise_is_known_to_be_possible(seed):
    """It costs f_in nine newtons for a moment: without its weight this is 4.5, not 1."""
    sensors = Sensors(rate_Hz=250.0, x_in_mm=Sensor(0.01), f_in_N=Sensor(0.1))
    run = prepared(Rig(), stroke_with_a_short_turn(), sensors=sensors, seed=seed)
    errors, rig = errors_of(run)
    assert np.sqrt(np.mean(errors.errors(rig)["f_in_N"] ** 2)) < 1.3
    assert np.median(errors.weights["f_in_N"] / run.noise["f_in_N"]) < 1.05


def test_a_run_that_is_done_with_leaves_memory_at_once():
    """Else thousands of calibrations in one process would wait for the collector of cycles."""
    errors, rig = errors_of(prepared(Rig(), sine()))
    errors.errors(rig)
    gone = weakref.ref(errors)
    gc.disable()
    try:
        del errors
        assert gone() is None
    finally:
        gc.enable()
