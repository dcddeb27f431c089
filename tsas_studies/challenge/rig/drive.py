"""The harmonic drive from motor speed to x_in: linear, integrated exactly.

    τ dw/dt + w = u                                      the motor follows the wanted speed u
    dx_m/dt = K w,  K = 2π r1 / (60 im)                  x_m: what the turntable would do if stiff
    (J/r1²) d²x/dt² + B dx/dt + k_p x = k_d (x_m − x)    x: the tendon at the drive

k_d is the stiffness of the drive in series and reacts on the position; k_p is what the tendon
sheath pulls back with, a linear stand-in (kL e^{μθ}, contraction) for the hysteretic one. See
Yang 2025, Eqs. (23)–(25), which lack the reaction of k_d, and (46)–(48).

With a `Gear` x_m gets the waves of its flexspline and passes through play before the spring, and
the motor hears of u later; this is integrated on a finer clock.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.drive_end import followed
from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.tendon import CleanRun


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


@dataclass(frozen=True)
class Gear:
    """What is not perfect between the asked speed and the drive's spring; all zeros are."""

    delay_s: float = 0.0  # how much later the motor hears of the asked speed
    # sine · sin(2φ) + cosine · (cos(2φ) − 1) is added to x_m, φ the motor's angle: two waves for
    # each turn of the wave generator.
    ripple_sine_mm: float = 0.0
    ripple_cosine_mm: float = 0.0
    play_mm: float = 0.0  # of the gear, which starts in its middle


def run_geared(
    drive: Drive, gear: Gear, time_s: Floats, motor_speed_rpm: Floats, finer: int = 10
) -> CleanRun:
    """Drive from rest with an imperfect gear, on a clock so many times as fine as the samples."""
    fine = np.interp(
        np.arange(finer * (time_s.size - 1) + 1) / finer, np.arange(time_s.size), time_s
    )
    u = np.interp(fine - gear.delay_s, time_s, motor_speed_rpm, left=0.0)
    h = fine[1] - fine[0]
    A, b = drive.matrices()
    turned = _linear(A[:2, :2], b[:2], h, u)[:, 1]
    angle = 2.0 * np.pi * turned / drive.gain_mm_per_s_rpm / 60.0
    waves = gear.ripple_sine_mm * np.sin(2.0 * angle)
    waves += gear.ripple_cosine_mm * (np.cos(2.0 * angle) - 1.0)
    dragged = followed(turned + waves, gear.play_mm)
    x = _linear(A[2:, 2:], A[2:, 1], h, dragged)[::finer, 0]
    return CleanRun({"time_s": time_s, "motor_speed_rpm": motor_speed_rpm, "x_in_mm": x})


def _linear(A: Floats, b: Floats, h: float, u: Floats) -> Floats:
    """Return the states of dy/dt = A y + b u from rest, u linear between samples, shape (n, 2)."""
    whole = np.zeros((4, 4))
    whole[:2, :2], whole[:2, 2], whole[2, 3] = A, b, 1.0
    step = expm(whole * h)
    now, then = step[:2, 2] - step[:2, 3] / h, step[:2, 3] / h
    return _stepped(np.ascontiguousarray(step[:2, :2]), now, then, u)


@compiled
def _stepped(step: Floats, now: Floats, then: Floats, u: Floats) -> Floats:
    y = np.zeros((u.size, 2))
    for i in range(u.size - 1):
        for j in range(2):
            y[i + 1, j] = step[j, 0] * y[i, 0] + step[j, 1] * y[i, 1]
            y[i + 1, j] += now[j] * u[i] + then[j] * u[i + 1]
    return y
