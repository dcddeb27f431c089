"""Drives fitted to what equations of `drive/harmonic_drive.py` give, without noise."""

import math

import numpy as np
import pytest

from tsas_cli.drive.fit import GAIN, DriveBench, quantities_of, replace_defaults, response_at
from tsas_cli.drive.harmonic_drive import DriveValues, gear_response, linear_response
from tsas_cli.drive.json import bode_curve, poles
from tsas_cli.drive.runs import DriveRun, FrequencyResponse, frequency_response
from tsas_cli.numerics.linear_response import sampled

STEP_S = 5e-3
TIME_S = STEP_S * np.arange(2001)
NOISE_MM = 1e-3
TRUTH = DriveValues(
    gain_mm_per_s_rpm=0.0236,
    motor_lag_s=0.012,
    delay_s=0.02,
    leak_per_s=0.3,
    natural_frequency_Hz=9.0,
    damping_ratio=0.15,
)


def speed(kind):
    if kind == "chirp":
        return 900.0 * np.sin(2.0 * np.pi * (0.3 * TIME_S + 0.5 * 2.0 * TIME_S**2))
    return 300.0 * np.sign(np.sin(2.1 * TIME_S)) + 100.0 * np.sin(13.0 * TIME_S)


def driven(values, kind="chirp", *, noise_mm=NOISE_MM):
    u = sampled(STEP_S, speed(kind), "first")
    x = 1.7 + linear_response(u, values) + gear_response(u, values, 1.7)
    return DriveRun(kind, u, x, noise_mm, at_rest=True)


def bench(values, stated_Hz=None):
    runs = [driven(values), driven(values, "steps")]
    return DriveBench(runs, frequency_response(runs), stated_Hz)


def response_by_hand(values, jw):
    lag = jw * values.motor_lag_s + 1.0
    w = 2.0 * math.pi * values.natural_frequency_Hz
    spring = (jw / w) ** 2 + 2.0 * values.damping_ratio * jw / w + 1.0 if w else 1.0
    late = np.exp(-jw * values.delay_s)
    return values.gain_mm_per_s_rpm * late / ((jw + values.leak_per_s) * lag * spring)


JW = 2j * math.pi * np.geomspace(0.1, 60.0, 40)


def test_the_response_is_that_of_the_equations():
    np.testing.assert_allclose(response_at(TRUTH, JW), response_by_hand(TRUTH, JW), rtol=1e-12)
    magnitude, phase = bode_curve(TRUTH, JW.imag / (2.0 * math.pi))
    exact = response_by_hand(TRUTH, JW)
    np.testing.assert_allclose(magnitude, np.abs(exact), rtol=1e-9)
    turns = (phase - np.degrees(np.angle(exact))) / 360.0
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-6)
    assert np.all(np.diff(phase) < 0.0)
    w = 2.0 * math.pi * 9.0
    swinging = complex(-0.15 * w, w * math.sqrt(1.0 - 0.15**2))
    expected = [-0.3, -1.0 / 0.012, swinging, swinging.conjugate()]
    np.testing.assert_allclose(np.sort_complex(poles(TRUTH)), np.sort_complex(expected), rtol=1e-6)


@pytest.mark.parametrize(
    "terms", [(), ("lag",), ("delay",), ("leak", "lag"), ("spring", "delay"), ("spring", "leak")]
)
def test_linear_terms_are_found_again(terms):
    kept = {q.name: getattr(TRUTH, q.name) for q in quantities_of(terms)}
    truth = DriveValues(**kept)
    stand = bench(truth)
    simpler = [stand.fit(set(terms) - {"leak"})] if "leak" in terms else []  # as a search goes
    found = stand.fit(terms, simpler)
    assert found.mean_square < 1e-3
    for name, value in kept.items():
        assert getattr(found.values, name) == pytest.approx(value, rel=2e-3), name
    assert found.solution.converged


def test_ripple_and_play_are_found_again():
    truth = DriveValues(0.0236, sine_mm=0.03, cosine_mm=-0.02, play_mm=0.08)
    stand = bench(truth)
    plain = stand.fit(())
    found = stand.fit(("ripple", "play"), [plain])
    assert plain.mean_square > 50.0
    assert found.mean_square < 0.3
    assert found.values.sine_mm == pytest.approx(0.03, abs=1e-3)
    assert found.values.cosine_mm == pytest.approx(-0.02, abs=1e-3)
    assert found.values.play_mm == pytest.approx(0.08, abs=4e-3)


def test_a_richer_set_fits_no_worse_than_what_it_starts_from():
    stand = bench(TRUTH)
    simpler = stand.fit(("spring",))
    richer = stand.fit(("spring", "leak"), [simpler])
    assert richer.mean_square <= simpler.mean_square


def test_the_stated_frequency_is_taken_for_granted():
    truth = TRUTH._replace(motor_lag_s=0.0, delay_s=0.0, leak_per_s=0.0, damping_ratio=0.4)
    found = bench(truth, stated_Hz=9.0).fit(("stated",))
    assert found.values.natural_frequency_Hz == 9.0
    assert found.values.damping_ratio == pytest.approx(0.4, rel=1e-2)
    assert [u.name for u in found.unknowns] == ["gain_mm_per_s_rpm", "damping_ratio"]


def test_a_run_is_simulated_from_where_it_fits_best():
    truth = TRUTH._replace(motor_lag_s=0.0)
    stand = bench(truth)
    np.testing.assert_allclose(stand.simulated(0, truth), stand.runs[0].x_in, atol=1e-9)
    off = truth._replace(gain_mm_per_s_rpm=0.03)
    simulated = stand.simulated(1, off)
    assert np.mean(simulated - stand.runs[1].x_in) == pytest.approx(0.0, abs=1e-9)
    moved = linear_response(stand.runs[1].u, off)
    np.testing.assert_allclose(simulated - moved, (simulated - moved)[0], atol=1e-9)


def test_the_first_gain_is_the_way_per_turn_the_less_noisy_run_counting_most():
    two = [driven(DriveValues(0.02)), driven(DriveValues(0.03), noise_mm=1e-1)]
    start = DriveBench(two, frequency_response(two)).gain
    turns = [run.u.integral - run.u.integral.mean() for run in two]
    weights = np.array([turn @ turn for turn in turns]) / np.array([1e-6, 1e-2])
    assert start == pytest.approx(weights @ [0.02, 0.03] / weights.sum(), rel=1e-9)
    assert 0.02 < start < 0.0201
    backwards = [driven(DriveValues(-0.02))]
    assert DriveBench(backwards, frequency_response(backwards)).gain == GAIN.lower


def test_the_numbers_of_a_set_are_in_a_fixed_order_the_gain_first():
    names = [q.name for q in quantities_of(("play", "spring", "lag"))]
    assert names[:2] == ["gain_mm_per_s_rpm", "motor_lag_s"]
    assert names[2:] == ["natural_frequency_Hz", "damping_ratio", "play_mm"]
    usual = replace_defaults(("spring",), 0.5)
    assert usual.gain_mm_per_s_rpm == 0.5
    assert usual.natural_frequency_Hz > 0.0
    assert usual.motor_lag_s == 0.0


@pytest.mark.parametrize("wrong", [[], [5], [5, 30]])
def test_a_few_wrong_points_of_the_response_do_not_lead_the_start_astray(wrong):
    truth = DriveValues(0.0236, delay_s=0.02, natural_frequency_Hz=9.0, damping_ratio=0.15)
    frequency_Hz = np.linspace(0.5, 20.0, 40)
    response = response_by_hand(truth, 2j * math.pi * frequency_Hz)
    response[wrong] *= -6.0
    seen = FrequencyResponse(frequency_Hz, response, np.ones(40), np.ones(40, dtype=bool))
    start = DriveBench([driven(truth)], seen)._from_response(frozenset(("delay", "spring")))
    for name in ("gain_mm_per_s_rpm", "natural_frequency_Hz", "damping_ratio", "delay_s"):
        assert getattr(start, name) == pytest.approx(getattr(truth, name), rel=0.1), name
