import numpy as np
import pytest

from tsas_studies.challenge.rig.drive import Drive, Gear, run_drive, run_geared

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
