import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tsas_studies.challenge.rig.drive import Drive, Gear, run_drive, run_geared
from tsas_studies.challenge.rig.drive_end import DriveEnd, followed, sensed_force, tendon_end
from tsas_studies.challenge.rig.motions import sine, through
from tsas_studies.challenge.rig.tendon import Rig, simulate

DRIVE = Drive()


def test_kinematics():
    assert DRIVE.gain_mm_per_s_rpm == pytest.approx(0.0236492, abs=5e-8)


def test_a_constant_speed_is_held_back_by_the_series_stiffness():
    t = np.arange(3001) / 1000.0
    x = run_drive(DRIVE, t, np.full(t.size, 300.0)).columns["x_in_mm"]
    held = DRIVE.drive_stiffness_N_per_mm / (
        DRIVE.drive_stiffness_N_per_mm + DRIVE.pull_back_N_per_mm
    )
    assert (x[-1] - x[-1001]) / 300.0 == pytest.approx(0.0236492 * held, rel=1e-4)


def test_the_equations_of_motion_written_out():
    t = np.arange(201) / 1000.0
    u = 500.0 * np.sin(60.0 * t)
    mass = 0.1296 / 27.1**2

    def rate(time, y):
        w, x_m, x, v = y
        force = 52.0 * (x_m - x) - DRIVE.pull_back_N_per_mm * x - 0.007 * v
        return [(np.interp(time, t, u) - w) / 0.002, 0.0236492 * w, v, force / mass]

    exact = solve_ivp(rate, (0.0, 0.2), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-10, max_step=5e-4)
    np.testing.assert_allclose(run_drive(DRIVE, t, u).columns["x_in_mm"], exact.y[2], atol=1e-5)


MOTION = through([10.0, 2.0, 12.0], speed_mm_s=4.0, rate_Hz=200.0)


@cache
def run(**options):
    return simulate(Rig(cells=60, drive_end=DriveEnd(**options)), MOTION).columns


TURN = int(np.argmax(np.diff(MOTION.x_in_mm) < 0.0))  # the last sample of the first pull


def test_what_is_dragged_with_play():
    drive = np.array([0.0, 0.3, 1.0, 0.8, 0.0, 0.5, 2.0])
    assert followed(drive, 1.0) == pytest.approx([0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 1.5])
    np.testing.assert_array_equal(followed(drive, 0.0), drive)


def test_the_gear_turns_unevenly():
    end = DriveEnd(ripple_sine_mm=0.03, ripple_cosine_mm=0.02, ripple_period_mm=0.8)
    assert tendon_end(end, np.array([0.0, 0.2, 0.4, 0.6, 0.8])) == pytest.approx(
        [0.0, 0.2 + 0.03 - 0.02, 0.4 - 0.04, 0.6 - 0.03 - 0.02, 0.8]
    )


def test_friction_of_the_drive_jumps_by_twice_its_size_at_a_reversal():
    more = run(friction_N=1.5)["f_in_N"] - run()["f_in_N"]
    assert more[20 : TURN + 1] == pytest.approx(1.5)
    assert more[TURN + 1 : TURN + 300] == pytest.approx(-1.5)
    np.testing.assert_array_equal(run(friction_N=1.5)["f_out_N"], run()["f_out_N"])


def test_a_rough_spot_is_felt_where_it_is():
    end = DriveEnd(rough_N=3.0, rough_at_mm=6.0, rough_width_mm=0.5)
    x = sine().x_in_mm
    more = sensed_force(end, sine().time_s, x, np.zeros(x.size))
    assert np.abs(more[np.abs(x - 6.0) > 2.0]).max() < 1e-6
    for i in np.flatnonzero(np.diff(np.sign(x - 6.0)))[:4]:
        assert more[i] == pytest.approx(math.copysign(3.0, x[i + 1] - x[i]), rel=1e-3)


def test_a_pulley_at_the_drive_takes_its_share_of_the_tension_both_ways():
    columns = run(pulley_share=0.05)
    ratio = columns["f_in_N"] / run()["f_in_N"]
    assert ratio[20 : TURN + 1] == pytest.approx(1.05)
    assert ratio[TURN + 1 : TURN + 300] == pytest.approx(0.95)


T = np.arange(2001) / 1000.0
U = 600.0 * np.sin(3.0 * T)
STIFF = Drive(
    inertia_N_mm_s2=1e-3, drive_stiffness_N_per_mm=1e6, damping_N_s_per_mm=0.5, motor_lag_s=1e-6
)


def x_in(drive, gear, u=U):
    return run_geared(drive, gear, T, u).columns["x_in_mm"]


def test_a_perfect_gear_changes_nothing():
    exact = run_drive(Drive(), T, U).columns["x_in_mm"]
    np.testing.assert_allclose(x_in(Drive(), Gear()), exact, atol=1e-6)


def test_a_delay_shifts():
    late = x_in(Drive(), Gear(delay_s=0.005))
    np.testing.assert_allclose(late[5:], x_in(Drive(), Gear())[:-5], atol=1e-9)


def test_two_waves_for_each_turn_of_the_wave_generator():
    u = np.full(T.size, 60.0)  # one turn a second
    wave = x_in(STIFF, Gear(ripple_sine_mm=0.03, ripple_cosine_mm=0.01), u) - x_in(STIFF, Gear(), u)
    angle = 4.0 * np.pi * T
    np.testing.assert_allclose(wave, 0.03 * np.sin(angle) + 0.01 * (np.cos(angle) - 1), atol=1e-5)


def test_play_is_lost_at_a_reversal():
    gap = x_in(STIFF, Gear()) - x_in(STIFF, Gear(play_mm=0.08))
    assert gap.max() == pytest.approx(0.04, abs=1e-4)
    assert gap.min() == pytest.approx(-0.04, abs=1e-4)
