"""What counts in the fit, and how much: weights near reversals, samples near the ends."""

import gc
import math
import weakref
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import fractional_matrix_power

from tests.identification.recorded import manifest, prepared
from tsas_cli.identification.end_errors import REVERSAL_SD, advanced, beside, reversed_at_rest
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.run_errors import (
    ReversalShapes,
    RunErrors,
    _reversal_shapes,
    run_errors,
)
from tsas_cli.identification.run_simulation import fitted_samples
from tsas_cli.numerics.noise import Noise, with_memory
from tsas_cli.numerics.sums import scaled_without_shape
from tsas_studies.challenge.rig.motions import Motion, nested, sine, through, triangle, two_sines
from tsas_studies.challenge.rig.sensors import Sensor, Sensors
from tsas_studies.challenge.rig.tendon import Rig


def errors_of(run):
    rig = data_sheet(manifest(run)).rig(run.run)
    return run_errors(run, fitted_samples(run, rig), rig), rig


RATE_HZ = 250.0
FINE = Sensors(rate_Hz=RATE_HZ)


@pytest.mark.parametrize("make", [sine, triangle])
def test_the_tension_is_uncertain_after_a_reversal_and_sure_in_slip(make):
    """A turning point off by a micrometre moves the tension after it by newtons."""
    run = prepared(Rig(), make(rate_Hz=RATE_HZ), sensors=FINE)
    errors, _ = errors_of(run)
    weights = errors.weights["f_in_N"] / run.noise["f_in_N"]
    turn = int(run.conditioned["x_in_mm"].reversals[1])
    assert weights[turn + 1 : turn + 6].max() > 4.0
    assert weights[turn - 375 : turn - 125].max() < 1.05


@pytest.mark.parametrize("make", [sine, nested])
def test_a_true_model_s_errors_are_about_one(make):
    run = prepared(Rig(), make(rate_Hz=RATE_HZ), sensors=FINE, seed=3)
    errors, rig = errors_of(run)
    for found in errors.errors(rig).values():
        assert np.sqrt(np.mean(found**2)) < 1.3


@pytest.mark.parametrize("make", [sine, nested])
def test_a_true_model_errs_by_the_noise_and_by_what_noise_of_the_drive_does(make):
    """The floor of f_in is more than its own noise; that of a distal channel is its noise."""
    squares = {}
    for seed in range(6):
        run = prepared(Rig(), make(rate_Hz=RATE_HZ), sensors=FINE, seed=seed)
        errors, rig = errors_of(run)
        by_drive = errors.by_driven_ends(rig)
        for name, left in errors.raw(rig).items():
            sizes = run.noise[name], *(np.sqrt(np.mean(e**2)) for e in (by_drive[name], left))
            squares.setdefault(name, []).append(np.square(sizes))
    for name, each in squares.items():
        white, drive, found = np.mean(each, axis=0)
        assert 0.85 < np.sqrt((white + drive) / found) < 1.25
        assert bool(drive > 0.04 * white) is (name == "f_in_N")


@pytest.mark.parametrize("rate_Hz", [20.0, 30.0, 50.0])
def test_a_coarse_sample_may_lie_behind_the_reversal_that_it_seems_to_end(rate_Hz):
    """Were it compared, single errors of f_in would be 20 to 60 standard deviations."""
    for seed in range(4):
        run = prepared(Rig(), sine(rate_Hz=1000.0), sensors=Sensors(rate_Hz=rate_Hz), seed=seed)
        errors, rig = errors_of(run)
        found = errors.errors(rig)["f_in_N"]
        assert np.abs(found).max() < 8.0
        assert np.mean(found**2) < 1.1


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
    errors, rig = errors_of(prepared(Rig(), sine(rate_Hz=RATE_HZ), sensors=FINE))
    errors.errors(rig)
    gone = weakref.ref(errors)
    gc.disable()
    try:
        del errors
        assert gone() is None
    finally:
        gc.enable()


X = np.array([0.0, 1.0, 2.0, 2.9, 3.0, 2.95, 2.0, 1.0, 0.5, 1.5])
REVERSALS = np.array([0, 4, 8, 9])


def conditioned(sd=0.01):
    return SimpleNamespace(values=X, reversals=REVERSALS, sd=np.full(X.size, sd))


def errors_with(samples, measured=None, predicted=3.0, correlation=0.0):
    """Return errors of weight one, without the shape of a wrong turn."""
    size = max(at.max() for at in samples.values()) + 1
    run = SimpleNamespace(
        measured=measured or dict.fromkeys(samples, np.arange(size) ** 2.0),
        noises=dict.fromkeys(samples, Noise(1.0, correlation)),
    )
    return RunErrors(
        run,
        samples,
        None,
        lambda rig: dict.fromkeys(samples, np.full(size, predicted)),
        dict.fromkeys(samples, np.ones(size)),
        {n: ReversalShapes(np.zeros(at.size), np.array([0])) for n, at in samples.items()},
    )


@pytest.mark.parametrize(("at", "starts"), [([1, 2, 3, 5, 6, 7, 9], [0, 3, 6]), ([5, 6, 7], [0])])
def test_errors_in_the_shape_of_a_wrong_turn_are_taken_down_to_their_variance(at, starts):
    """Stroke by stroke (I + 3² c cᵀ)^(−1/2): the strokes begin after samples 0, 4 and 8."""
    at = np.array(at)
    change = np.random.default_rng(1).standard_normal(X.size)
    turns = _reversal_shapes(change, at, REVERSALS)
    assert turns.starts.tolist() == starts
    e = np.random.default_rng(2).standard_normal(X.size)
    scale = 1.0 + np.random.default_rng(3).random(X.size)
    reduced = scaled_without_shape(e * scale, scale, at, *turns)
    for first, end in pairwise([*starts, at.size]):
        c = change[at][first:end]
        root = fractional_matrix_power(np.eye(c.size) + REVERSAL_SD**2 * np.outer(c, c), -0.5)
        np.testing.assert_allclose(reduced[first:end], root @ e[at][first:end], atol=1e-12)


def test_a_stroke_that_a_wrong_turn_does_not_change_keeps_its_errors():
    at = np.arange(X.size)
    change = np.where(at < 5, 0.0, 1.0)
    turns = _reversal_shapes(change, at, REVERSALS)
    assert not turns.shape[:5].any()
    assert turns.shape[5:].all()


def test_every_stroke_is_moved_on_its_own_way():
    moved = advanced(conditioned(0.25)) - X
    assert moved.tolist() == [0.25] * 5 + [-0.25] * 4 + [0.25]


RESTING = np.array([0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 2.0, 1.0, 0.0])


@pytest.mark.parametrize(("sd", "step", "back"), [(0.01, 0.0, 0.01), (0.01, 0.2, 0.2)])
def test_where_the_drive_rests_it_may_have_turned_back(sd, step, back):
    """By its error or by a step, against the stroke that ends there, at every other sample."""
    resting = SimpleNamespace(
        values=RESTING,
        reversals=np.array([0, 6, 9]),
        sd=np.full(RESTING.size, sd),
        step=step,
        window_s=2.0,
    )
    turned = reversed_at_rest(resting, np.arange(10.0)) - RESTING
    expected = np.zeros(10)
    expected[[3, 5]] = -back
    expected[9] = back  # the run ends: whether it moves on is unknown
    assert turned == pytest.approx(expected)
    assert beside(turned) == pytest.approx(back * np.array([0, 0, 1, 1, 1, 1, 1, 0, 1, 1]))


@pytest.mark.parametrize(("hunting_mm", "count_mm"), [(0.0005, 0.001), (0.002, 0.004)])
def test_a_drive_that_hunts_at_rest_within_a_count_is_no_error(hunting_mm, count_mm):
    """A micrometre moves f_in there by tens of its noise, and the encoder does not show it."""
    way = through([8.0, 8.0, 3.0, 3.0, 9.0, 9.0, 0.0])
    window = np.hanning(401) / np.hanning(401).sum()  # no jerk
    smooth = np.convolve(np.pad(way.x_in_mm, 200, mode="edge"), window, "valid")
    phase = 2.0 * math.pi * way.time_s
    hunted = Motion(way.time_s, smooth + hunting_mm * np.sin(3.0 * phase) * np.sin(0.7 * phase))
    encoder = Sensors(rate_Hz=RATE_HZ, jitter_s=0.0, x_in_mm=Sensor(step=count_mm))
    errors, rig = errors_of(prepared(Rig(), hunted, sensors=encoder))
    assert np.abs(errors.raw(rig)["f_in_N"]).max() > 30.0 * errors.run.noise["f_in_N"]
    assert np.mean(errors.errors(rig)["f_in_N"] ** 2) < 1.0


def test_chosen_residuals_are_spread_over_the_samples_behind_them():
    """Of 2,500 samples three make a mean; channels follow each other."""
    made = errors_with({"f_in_N": np.arange(10), "x_out_mm": np.arange(2500)})
    chosen = np.zeros(10 + 834, dtype=bool)
    chosen[[3, 10, 12, 843]] = True
    assert np.flatnonzero(made.spread("f_in_N", chosen)).tolist() == [3]
    found = np.flatnonzero(made.spread("x_out_mm", chosen))
    assert found.tolist() == [0, 1, 2, 6, 7, 8, 2499]
    assert made.length == 2500
    assert made.count == made.residuals(None).size == chosen.size
    with pytest.raises(KeyError):
        made.spread("f_out_N", chosen)


def test_means_of_neighbours_keep_a_variance_of_one():
    white = np.random.default_rng(3).standard_normal(2500)
    made = errors_with({"f_in_N": np.arange(2500)}, {"f_in_N": -white}, predicted=0.0)
    found = made.residuals(None)
    assert found.size == 834
    assert found[0] == pytest.approx(white[:3].sum() / np.sqrt(3.0))
    assert found[-1] == white[-1]


def test_means_of_noise_with_a_memory_keep_a_variance_of_one_too():
    """Of three samples with a correlation of 0.5: 3 + 4 · 0.5 + 2 · 0.25 in place of 3."""
    noise = with_memory(np.random.default_rng(3).standard_normal(2500), 0.5)
    made = errors_with({"f_in_N": np.arange(2500)}, {"f_in_N": -noise}, 0.0, correlation=0.5)
    found = made.residuals(None)
    assert found[0] == pytest.approx(noise[:3].sum() / np.sqrt(5.5))
    assert np.mean(found**2) == pytest.approx(1.0, abs=0.15)


def test_raw_errors_are_measured_less_simulated():
    made = errors_with({"f_in_N": np.array([2, 5])})
    assert made.raw(None)["f_in_N"].tolist() == [1.0, 22.0]


def test_errors_over_the_noise_are_those_where_the_noise_rules():
    """At a steep reversal the error of the drive is most of the standard deviation."""
    errors = errors_with({"f_in_N": np.arange(4)})
    errors.run.noise = {"f_in_N": 0.1}
    steep = replace(errors, weights={"f_in_N": np.array([0.1, 0.19, 0.21, 0.9])})
    raw, chosen = np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, True, True])
    assert steep.over_noise("f_in_N", raw, chosen) == pytest.approx([20.0])
