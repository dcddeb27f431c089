"""What follows from a fitted drive, by the formulas of Yang 2025 and by runs of the drive."""

import math

import numpy as np
import pytest

from tests.drive.verdicts import manifest
from tsas_cli.drive.estimates import DataSheet, drive_sheet, estimates_of, total_lag_s
from tsas_cli.drive.fit import DriveTrial, quantities_of
from tsas_cli.drive.harmonic_drive import DriveValues, linear_response
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.numerics.linear_response import sampled

VALUES = DriveValues(
    0.02, motor_lag_s=0.013, delay_s=0.02, natural_frequency_Hz=11.0, damping_ratio=0.3
)
SHEET = DataSheet(27.1, 120.0, 0.1296, 2.3)
TERMS = ("lag", "delay", "spring")
RNG = np.random.default_rng(5)
BLOCKS = [np.repeat(np.arange(10), 20), np.repeat(np.arange(10), 20)]


def trial(values=VALUES, terms=TERMS, *, at_bound=(), weak=()):
    """A trial whose residual is white and whose columns have nothing in common."""
    quantities = quantities_of(terms)
    unknowns = tuple(
        Unknown(q.name, None, 0.0, q.scaled(q.lower), q.scaled(q.upper), 1.0) for q in quantities
    )
    scaled = np.array([q.scaled(getattr(values, q.name)) for q in quantities])
    jacobian = 300.0 * RNG.standard_normal((400, len(quantities)))
    for name in weak:
        jacobian[:, [q.name for q in quantities].index(name)] /= 1e8
    residual = RNG.standard_normal(400)
    residual -= jacobian @ np.linalg.lstsq(jacobian, residual, rcond=None)[0]
    bound = np.array([q.name in at_bound for q in quantities])
    solution = Solution(scaled, bound, residual, jacobian, True, "", 1)
    return DriveTrial(frozenset(terms), unknowns, solution, values)


def told(made=None, sheet=SHEET):
    return estimates_of(made or trial(), BLOCKS, sheet, by_run=False)


def test_it_trails_a_ramp_by_its_whole_lag():
    """Long after its start x_in is where the motor was that long ago."""
    step_s, speed = 1e-3, 100.0
    u = sampled(step_s, np.full(4001, speed), "first")
    behind = VALUES.gain_mm_per_s_rpm * u.integral - linear_response(u, VALUES)
    assert behind[-1] / (VALUES.gain_mm_per_s_rpm * speed) == pytest.approx(
        total_lag_s(VALUES), rel=1e-6
    )
    assert total_lag_s(DriveValues(0.02)) == 0.0
    assert total_lag_s(DriveValues(0.02, delay_s=0.1)) == 0.1


def test_what_the_data_sheet_says_follows_from_it():
    assert SHEET.kinematic_gain == pytest.approx(0.0236492, abs=1e-7)  # of the paper's rig
    assert SHEET.mass == pytest.approx(0.1296 / 27.1**2)
    w = 2.0 * math.pi * SHEET.stated_frequency
    assert SHEET.mass * w**2 == pytest.approx(2.3)
    for missing in range(4):
        values = [27.1, 120.0, 0.1296, 2.3]
        values[missing] = None
        sheet = DataSheet(*values)
        assert (sheet.kinematic_gain is None) == (missing in (0, 1))
        assert (sheet.mass is None) == (missing in (0, 2))
        assert (sheet.stated_frequency is None) == (missing in (0, 2, 3))


def test_the_tendon_pulls_back_with_its_stiffness_in_contraction():
    """Eq. (31), where one bend is known of all runs."""
    expected = 1.579 * math.exp(0.125 * 3.0)
    assert drive_sheet(manifest()).pull_back_N_per_mm == pytest.approx(expected)
    for unknown in (
        manifest((3.0, 2.0)),
        manifest((None, None)),
        manifest(friction_coefficient=None),
        manifest(load_stiffness_N_per_mm=None),
    ):
        assert drive_sheet(unknown).pull_back_N_per_mm is None


def test_derived_numbers_are_those_of_the_equations():
    """g = K kd/(kd + kp), ω² = (kd + kp)/m, 2ζω = B/m: made from kd, kp, B and read again."""
    m, kd, kp, B = SHEET.mass, 40.0, 3.0, 0.01
    w = math.sqrt((kd + kp) / m)
    values = VALUES._replace(
        gain_mm_per_s_rpm=SHEET.kinematic_gain * kd / (kd + kp),
        natural_frequency_Hz=w / (2.0 * math.pi),
        damping_ratio=B / (2.0 * w * m),
    )
    found = {name: e.value for name, e in told(trial(values)).items()}
    assert found["drive_stiffness_N_per_mm"] == pytest.approx(kd)
    assert found["pull_back_N_per_mm"] == pytest.approx(kp)
    assert found["compliance_mm_per_N"] == pytest.approx(1.0 / kd)
    assert found["damping_N_s_per_mm"] == pytest.approx(B)
    assert found["kV_rpm_s_per_mm"] == pytest.approx(1.0 / values.gain_mm_per_s_rpm)
    lag = total_lag_s(values) / values.gain_mm_per_s_rpm
    assert found["kA_rpm_s2_per_mm"] == pytest.approx(lag)


def test_what_the_data_sheet_does_not_say_is_not_derived():
    without_gear = told(sheet=DataSheet(27.1, None, 0.1296, None))
    assert "whole_stiffness_N_per_mm" in without_gear
    assert "drive_stiffness_N_per_mm" not in without_gear
    w = 2.0 * math.pi * 11.0
    whole = without_gear["whole_stiffness_N_per_mm"].value
    assert whole == pytest.approx(0.1296 / 27.1**2 * w * w)
    without_mass = told(sheet=DataSheet(27.1, 120.0, None, None))
    assert {n for n in without_mass if n.startswith("k")} == {"kV_rpm_s_per_mm", "kA_rpm_s2_per_mm"}
    assert "damping_N_s_per_mm" not in without_mass
    stiff = told(trial(DriveValues(0.02), ()))
    assert set(stiff) == {"gain_mm_per_s_rpm", "kV_rpm_s_per_mm"}


def test_intervals_of_positive_numbers_are_factors_and_of_others_sums():
    found = told()
    gain, lag = found["gain_mm_per_s_rpm"], found["motor_lag_s"]
    assert gain.interval_low * gain.interval_high == pytest.approx(gain.value**2)
    assert gain.interval_low < gain.value < gain.interval_high
    half = 0.5 * math.log(gain.interval_high / gain.interval_low)
    assert 1.9 < half * gain.value / gain.stderr < 3.0
    assert lag.interval_low + lag.interval_high == pytest.approx(2.0 * lag.value)
    assert 1.9 < (lag.interval_high - lag.value) / lag.stderr < 3.0
    # White residuals: the columns' own length tells the error, here of a number in 0.01 s.
    assert lag.stderr == pytest.approx(0.01 / (300.0 * math.sqrt(400.0)), rel=0.6)


def test_intervals_end_at_the_bounds():
    vague = told(trial(weak=("motor_lag_s", "natural_frequency_Hz")))
    for name, bounds in (("motor_lag_s", (0.0, 5.0)), ("natural_frequency_Hz", (0.05, 2e3))):
        ends = vague[name].interval_low, vague[name].interval_high
        assert ends == pytest.approx(bounds, rel=1e-12)


def test_the_error_of_what_two_unknowns_move_is_that_of_both():
    """B = 2 m ζω, of independent ζ and ω: relative errors add by their squares; 1/g has one."""
    found = told()
    gain, kV = found["gain_mm_per_s_rpm"], found["kV_rpm_s_per_mm"]
    assert kV.stderr / kV.value == pytest.approx(gain.stderr / gain.value, rel=1e-4)
    assert 0.5 * (kV.interval_low + kV.interval_high) == pytest.approx(kV.value)
    parts = [found[n].stderr / found[n].value for n in ("natural_frequency_Hz", "damping_ratio")]
    B = found["damping_N_s_per_mm"]
    assert B.stderr / B.value == pytest.approx(math.hypot(*parts), rel=0.35)
    assert B.stderr / B.value > 0.9 * max(parts)


def test_a_number_is_flagged_where_one_that_moves_it_is_at_its_bound():
    found = told(trial(at_bound=("damping_ratio",)))
    flagged = {name for name, e in found.items() if e.at_bound}
    assert flagged == {"damping_ratio", "damping_N_s_per_mm", "kA_rpm_s2_per_mm"}
