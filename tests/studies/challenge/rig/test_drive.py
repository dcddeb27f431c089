import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tsas_studies.challenge.rig.drive import Drive, run_drive

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
