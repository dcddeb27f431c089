"""Motions of the drive: x_in [mm] over time [s], each starting at 0 mm and pulling first."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """x_in over time; linear between the samples."""

    time_s: Floats
    x_in_mm: Floats


def clock(duration_s: float, rate_Hz: float) -> Floats:
    """Return the times from 0 to the duration, both ends included where the rate allows."""
    return np.arange(int(np.floor(duration_s * rate_Hz + 1e-9)) + 1) / rate_Hz


def sine(
    amplitude_mm: float = 10.0,
    omega_rad_s: float = 1.0,
    periods: float = 2.0,
    rate_Hz: float = 1000.0,
) -> Motion:
    """Return the motion of the paper, A sin(ωt − π/2) + A."""
    t = clock(periods * 2.0 * np.pi / omega_rad_s, rate_Hz)
    return Motion(t, amplitude_mm * (1.0 - np.cos(omega_rad_s * t)))


def two_sines(
    amplitudes_mm: Sequence[float] = (6.0, 3.0),
    omegas_rad_s: Sequence[float] = (1.0, 3.7),
    duration_s: float = 12.0,
    rate_Hz: float = 1000.0,
) -> Motion:
    """Two frequencies at once, with partial reversals where the fast one wins."""
    t = clock(duration_s, rate_Hz)
    x = np.zeros(t.size)
    for A, w in zip(amplitudes_mm, omegas_rad_s, strict=True):
        x += A * (1.0 - np.cos(w * t))
    return Motion(t, x)


def through(points_mm: npt.ArrayLike, speed_mm_s: float = 5.0, rate_Hz: float = 1000.0) -> Motion:
    """Go from one point to the next at constant speed; a point given twice waits for 1 s."""
    points = np.concatenate(([0.0], np.asarray(points_mm, dtype=float)))
    distance = np.abs(np.diff(points))
    lasts = np.where(distance > 0.0, distance / speed_mm_s, 1.0)
    corners = np.concatenate(([0.0], np.cumsum(lasts)))
    t = clock(corners[-1], rate_Hz)
    return Motion(t, np.interp(t, corners, points))


def triangle(
    amplitude_mm: float = 10.0, speed_mm_s: float = 5.0, periods: int = 2, rate_Hz: float = 1000.0
) -> Motion:
    """Up to twice the amplitude and back at constant speed."""
    return through([2.0 * amplitude_mm, 0.0] * periods, speed_mm_s, rate_Hz)


def nested(amplitude_mm: float = 10.0, speed_mm_s: float = 5.0, rate_Hz: float = 1000.0) -> Motion:
    """Partial reversals, each inside the one before, then out again the same way."""
    A = amplitude_mm
    points = [2.0 * A, 0.5 * A, 1.5 * A, 0.8 * A, 1.1 * A, 0.8 * A, 1.5 * A, 0.5 * A, 2.0 * A, 0.0]
    return through(points, speed_mm_s, rate_Hz)


def steps(
    levels_mm: npt.ArrayLike = (5.0, 12.0, 8.0, 16.0, 0.0),
    speed_mm_s: float = 20.0,
    rate_Hz: float = 1000.0,
) -> Motion:
    """Quick ramps from level to level, with 1 s of rest on each."""
    return through(np.repeat(levels_mm, 2), speed_mm_s, rate_Hz)


def dwell(amplitude_mm: float = 10.0, speed_mm_s: float = 5.0, rate_Hz: float = 1000.0) -> Motion:
    """Slow strokes that stop for 1 s on the way up, at the top, on the way down and at 0."""
    levels = amplitude_mm * np.array([1.0, 2.0, 1.0, 0.0])
    return steps(np.tile(levels, 2), speed_mm_s, rate_Hz)


def chirp(
    amplitude_mm: float = 5.0,
    from_Hz: float = 0.05,
    to_Hz: float = 0.8,
    duration_s: float = 20.0,
    rate_Hz: float = 1000.0,
) -> Motion:
    """Sweep as A (1 − cos), with a frequency that grows exponentially."""
    t = clock(duration_s, rate_Hz)
    growth = np.log(to_Hz / from_Hz) / duration_s
    phase = 2.0 * np.pi * from_Hz * np.expm1(growth * t) / growth
    return Motion(t, amplitude_mm * (1.0 - np.cos(phase)))
