"""The drive's path: smoothing against what it is by algebra, the whole against the model."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.controllers.path import drive_at, follow, geared_at, smoothed
from tsas_cli.numerics.wave import Wave
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.support.errors import InputError

H = 0.002
T = H * np.arange(4001)
SINE = 43.0 - 18.0 * np.cos(2.0 * T)
CROSSING_S = 0.08
WIDTH = 10
STIFF = Actuator(0.0236, math.inf, 1.8e-4, 0.007, 0.0, 3000.0)
NODES = 20


def spread(width, step_s):
    """Return the variance of the four means by which x is smoothed [s²].

    That of one, whose two outer samples count half, is (width² + 2)/12 steps².
    """
    return 4.0 * (width**2 + 2.0) / 12.0 * step_s**2


@pytest.mark.parametrize("width", [1, 4, 25])
def test_smoothing_is_exact_on_cubics_but_for_its_spread(width):
    h = 0.01
    t = h * np.arange(301)
    x, rates = 2.0 - 3.0 * t + 5.0 * t**2 - 7.0 * t**3, smoothed
    place, speed, acceleration, jerk = rates(x, width, h)
    inner = t[2 * width : t.size - 2 * width]
    half, third = 10.0 - 42.0 * inner, -42.0
    exact = 2.0 - 3.0 * inner + 5.0 * inner**2 - 7.0 * inner**3
    np.testing.assert_allclose(place, exact + 0.5 * spread(width, h) * half, atol=1e-9)
    # Of a mean that has become a difference (of variance width²/12) only the rest remains.
    less = [spread(width, h) - k * 2.0 / 12.0 * h**2 for k in range(3)]
    exact = -3.0 + 10.0 * inner - 21.0 * inner**2
    np.testing.assert_allclose(speed, exact + 0.5 * less[1] * third, atol=1e-8)
    np.testing.assert_allclose(acceleration, half, atol=1e-6)
    np.testing.assert_allclose(jerk, third, rtol=1e-5)


def test_rates_are_the_differences_of_what_they_are_rates_of():
    """To rounding: each step of a row is the mean of the next row's two values there."""
    x = np.cumsum(np.random.default_rng(3).standard_normal(400))
    rows = smoothed(x, 7, 0.004)
    for row, rate in pairwise(rows):
        steps = np.diff(row) / 0.004
        np.testing.assert_allclose(steps, 0.5 * (rate[1:] + rate[:-1]), atol=1e-9 / 0.004**3)


def test_a_jump_is_crossed_in_the_crossing_time_and_without_overshoot():
    x = np.where(np.arange(200) < 100, 1.0, 4.0)
    width, h = 8, 0.005
    place, speed, acceleration, jerk = smoothed(x, width, h)
    moving = np.flatnonzero(speed > 1e-9)
    assert abs(moving.size - 4 * width) <= 1
    assert (place.min(), place.max()) == pytest.approx((1.0, 4.0))
    assert np.diff(place).min() > -1e-12
    assert place[100 - 2 * width] + place[99 - 2 * width] == pytest.approx(5.0)
    # The cubic B-spline and its slope are at most 2/3, in units of its quarter.
    quarter = width * h
    assert speed.max() == pytest.approx(3.0 * 2.0 / 3.0 / quarter, rel=0.02)
    assert np.abs(acceleration).max() == pytest.approx(3.0 * 2.0 / 3.0 / quarter**2, rel=0.05)
    for row, most in ((place, 1.1 * speed.max()), (speed, 1.1 * np.abs(acceleration).max())):
        assert np.abs(np.diff(row)).max() < most * h
    assert np.abs(np.diff(acceleration)).max() < 1.1 * np.abs(jerk).max() * h


def path_to(wanted_N, values=None, *, actuator=STIFF, crossing_s=CROSSING_S):
    rig = with_values(GROUP_A, values or {})
    path = follow(wanted_N, H, rig, actuator, crossing_s=crossing_s, nodes=NODES)
    assert path.missed == 0
    assert path.drive.shape == path.motor.shape == (4, wanted_N.size)
    return path


def test_a_reference_shorter_than_the_crossing_is_refused():
    with pytest.raises(InputError, match=r"reference of 0\.078 s.*0\.08 s"):
        path_to(np.full(39, 30.0))


def test_a_held_force_is_a_held_place():
    """Eq. (22), its mesh of 20 nodes aside."""
    rows = path_to(np.full(40, 30.0)).drive
    a, give = 0.125 * math.pi, 250.0 * math.pi / 67858.4
    expected = 5.0 / 1.579 + 30.0 * give * math.expm1(a) / a - 25.0 * give
    np.testing.assert_allclose(rows[0], expected, atol=1e-3)
    np.testing.assert_allclose(rows[1:], 0.0, atol=1e-3)


STRIBECK = {"stribeck_friction.excess": 0.6, "stribeck_friction.velocity_mm_per_s": 15.0}
ALONG = {
    "none": {},
    "backlash": {"backlash.play_mm": 0.3},
    "ripple": {"drive_ripple.sine_mm": 0.05, "drive_ripple.cosine_mm": 0.03},
    "backlash and ripple": {"backlash.play_mm": 0.3, "drive_ripple.cosine_mm": 0.06},
    "free tendon": {"free_tendon.proximal_length_mm": 152.0},
    "load friction": {"load_friction.before_sensor_N": 6.0},
    "viscous friction": {"viscous_friction.coefficient_N_s_per_mm": 1.0},
    "stribeck friction": STRIBECK,
    "presliding": {"presliding.length_mm": 2.0},
    "load spring": {"load_spring_nonlinearity.quadratic_per_mm": 0.03},
    "friction drift": {"friction_drift.rate_per_s": 0.05},
    "position-dependent friction": {"position_dependent_friction.slope_per_mm": 0.04},
    "law of the sheath": {
        "tendon_law.travel_mm": 4.0,
        "tendon_law.start_1": 1.0,
        "tendon_law.high_mm": 25.0,
        "tendon_law.curve_4": 1.0,
        "tendon_law.fast_mm_per_s": 30.0,
        "tendon_law.speed_3": -0.2,
    },
}
# The load turns later than the force, and yields with a kink that the path smooths.
LATE = {
    "load damping": {"load_damping.coefficient_N_s_per_mm": 0.2},
    "load hysteresis": {"load_hysteresis.force_N": 3.0},
}


@pytest.mark.parametrize("values", (ALONG | LATE).values(), ids=(ALONG | LATE).keys())
def test_the_model_driven_along_the_path_gives_the_wanted_force(values):
    """Between the turns; what smoothing takes off is x″ crossing²/96, 0.006 mm at most here."""
    path = path_to(SINE, values)
    rig = with_values(GROUP_A, values)
    there = simulate(rig, DriveInput(path.drive[0], time_s=T), nodes=NODES)
    between = (np.abs(np.sin(2.0 * T)) > 0.27) & (T[-1] - CROSSING_S > T)
    if values in LATE.values():
        between &= np.sin(2.0 * T) * np.cos(2.0 * T) < 0.0  # the second half of each stroke
    np.testing.assert_allclose(there.f_out_N[between], SINE[between], atol=0.04)
    if values:
        other = simulate(GROUP_A, DriveInput(path.drive[0], time_s=T), nodes=NODES)
        assert np.abs(other.f_out_N[between] - SINE[between]).max() > 0.1


def test_the_path_is_known_ahead_and_begins_and_ends_at_rest():
    """A jump of the wanted force is crossed half before, half after it."""
    wanted = np.where(T < 4.0, 30.0, 40.0)
    path = path_to(wanted, crossing_s=0.4)
    moving = np.flatnonzero(np.abs(path.drive[1]) > 1e-9) * H
    assert moving[[0, -1]] == pytest.approx((3.8, 4.2), abs=2 * H)
    for order in (1, 2, 3):
        assert path.drive[order, [0, -1]] == pytest.approx((0.0, 0.0), abs=1e-9 / H**order)


def test_the_motor_winds_up_the_gear_by_what_hangs_at_it():
    values = {
        "proximal_spring.stiffness_N_per_mm": 12.5,
        "drive_friction.friction_N": 3.0,
        "drive_damping.coefficient_N_s_per_mm": 0.5,
        "drive_inertia.mass_kg": 2.0,
        "drive_law.travel_mm": 4.0,
        "drive_law.friction_2_N": 2.0,
        "drive_law.share_3": 0.05,
    }
    soft = STIFF._replace(stiffness_N_per_mm=52.0)
    rig = with_values(GROUP_A, values)
    assert (path_to(SINE, values).motor == path_to(SINE, values).drive).all()
    path = path_to(SINE, values, actuator=soft)
    f_in = simulate(rig, DriveInput(path.drive[0], time_s=T), nodes=NODES).f_in_N
    wound = (f_in - GROUP_A.preload_N) / 52.0
    between = np.abs(np.sin(2.0 * T)) > 0.25
    np.testing.assert_allclose((path.motor - path.drive)[0][between], wound[between], atol=0.01)


STEEP = {"drive_ripple.sine_mm": 0.08, "drive_ripple.cosine_mm": -0.05}


def test_play_and_ripple_are_taken_back():
    """The drive at the found places moves the tendon's end where it was wanted."""
    rig = with_values(GROUP_A, STEEP | {"backlash.play_mm": 0.3})
    end = np.concatenate((np.linspace(0.0, 6.0, 500), np.linspace(6.0, -1.0, 400)))
    geared = geared_at(end, rig.effects)
    drive = drive_at(np.vstack((geared, np.zeros((3, 900)))), rig.effects.drive_ripple, H)[0]
    np.testing.assert_allclose(ends_of(rig, DriveInput(drive)).drive, end, atol=1e-9)
    assert np.abs(drive - geared).max() > 0.08


def test_rates_with_ripple_are_those_of_the_drive():
    """Gear's output 3t³: the drive's rates by the rule of the inverse function."""
    step_s = 2e-4
    t = 0.5 + step_s * np.arange(2501)
    ripple = Wave(sine_mm=0.03, cosine_mm=-0.02, period_mm=0.9)
    rows = drive_at(np.vstack((3.0 * t**3, np.zeros((3, t.size)))), ripple, step_s)
    k = 2.0 * np.pi / 0.9
    sine, cosine = np.sin(k * rows[0]), np.cos(k * rows[0])
    slope = 1.0 + k * (0.03 * cosine + 0.02 * sine)
    bend = k**2 * (-0.03 * sine + 0.02 * cosine)
    np.testing.assert_allclose(rows[1] * slope, 9.0 * t**2, rtol=2e-3)
    np.testing.assert_allclose(
        (rows[2] * slope + bend * rows[1] ** 2)[2:-2], 18.0 * t[2:-2], rtol=0.02
    )
    twist = -(k**3) * (0.03 * cosine + 0.02 * sine)
    third = rows[3] * slope + 3.0 * bend * rows[1] * rows[2] + twist * rows[1] ** 3
    np.testing.assert_allclose(third[3:-3], 18.0, atol=1e-3 * np.abs(rows[3]).max())


def test_a_path_that_begins_away_from_the_preload_begins_across_the_play():
    """The drive comes from x = 0, so that its play is on the side that it has come from."""
    values = {"backlash.play_mm": 0.3}
    for wanted, side in ((40.0, 1.0), (15.0, -1.0)):
        path = path_to(np.full(100, wanted), values)
        plain = path_to(np.full(100, wanted))
        np.testing.assert_allclose(path.drive[0] - plain.drive[0], side * 0.15, atol=1e-9)
