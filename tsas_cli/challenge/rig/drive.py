"""The harmonic drive from motor speed to x_in: linear, integrated exactly.

    τ dw/dt + w = u                                      the motor follows the wanted speed u
    dx_m/dt = K w,  K = 2π r1 / (60 im)                  x_m: what the turntable would do if stiff
    (J/r1²) d²x/dt² + B dx/dt + k_p x = k_d (x_m − x)    x: the tendon at the drive

k_d is the stiffness of the drive in series and reacts on the position; k_p is what the tendon
sheath pulls back with, a linear stand-in (kL e^{μθ}, contraction) for the hysteretic one. See
Yang 2025, Eqs. (23)–(25), which lack the reaction of k_d, and (46)–(48).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from tsas_cli.challenge.rig.motions import Floats
from tsas_cli.challenge.rig.tendon import CleanRun


@dataclass(frozen=True)
class Drive:
    """The drive's true parameters; r1, im, J and B are the paper's."""

    turntable_radius_mm: float = 27.1
    gear_ratio: float = 120.0
    inertia_N_mm_s2: float = 0.1296
    damping_N_s_per_mm: float = 0.007
    drive_stiffness_N_per_mm: float = 52.0
    pull_back_N_per_mm: float = 1.579 * math.exp(0.125 * math.pi)
    motor_lag_s: float = 0.002

    @property
    def gain_mm_per_s_rpm(self) -> float:
        """K, 0.0236492 mm/s per rpm."""
        return 2.0 * math.pi * self.turntable_radius_mm / (60.0 * self.gear_ratio)

    def matrices(self) -> tuple[Floats, Floats]:
        """Return A and b of dy/dt = A y + b u for the state y = (w, x_m, x, dx/dt)."""
        mass = self.inertia_N_mm_s2 / self.turntable_radius_mm**2
        k_d, k_p = self.drive_stiffness_N_per_mm, self.pull_back_N_per_mm
        A = np.zeros((4, 4))
        A[0, 0] = -1.0 / self.motor_lag_s
        A[1, 0] = self.gain_mm_per_s_rpm
        A[2, 3] = 1.0
        A[3] = np.array([0.0, k_d, -(k_d + k_p), -self.damping_N_s_per_mm]) / mass
        return A, np.array([1.0 / self.motor_lag_s, 0.0, 0.0, 0.0])


def run_drive(drive: Drive, time_s: Floats, motor_speed_rpm: Floats) -> CleanRun:
    """Drive from rest; u is linear between its evenly spaced samples, so the result is exact."""
    A, b = drive.matrices()
    h = time_s[1] - time_s[0]
    # The matrix exponential of (y, u, du/dt) as one system gives the step of a linear input.
    whole = np.zeros((6, 6))
    whole[:4, :4], whole[:4, 4], whole[4, 5] = A, b, 1.0
    step = expm(whole * h)
    y = np.zeros(4)
    x = np.zeros(time_s.size)
    slope = np.diff(motor_speed_rpm) / h
    for i in range(slope.size):
        y = step[:4, :4] @ y + step[:4, 4] * motor_speed_rpm[i] + step[:4, 5] * slope[i]
        x[i + 1] = y[2]
    return CleanRun({"time_s": time_s, "motor_speed_rpm": motor_speed_rpm, "x_in_mm": x})
