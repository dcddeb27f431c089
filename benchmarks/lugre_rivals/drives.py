"""How the drive moves: a sum of sines, or noisy samples of one."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

Floats: TypeAlias = NDArray[np.float64]

NO_SINES, NO_PIECES = np.empty((0, 3)), np.empty((0, 5))


class Tables(NamedTuple):
    """A drive for compiled code, row after row in memory; one of the two tables is empty."""

    sines: Floats  # rows of amplitude [mm], angular frequency [rad/s] and phase [rad]
    # Rows of start [s] and the coefficients of a cubic from there, the highest power first, of
    # equal duration.
    pieces: Floats


class Sine(NamedTuple):
    """One sine."""

    amplitude_mm: float
    omega_rad_s: float
    phase_rad: float = -np.pi / 2.0


@dataclass(frozen=True)
class Sines:
    """A sum of sines, shifted so that it begins at zero: x_in = Σ A (sin(ω t + φ) − sin φ)."""

    sines: tuple[Sine, ...]

    def position(self, time_s: Floats) -> Floats:
        """Return x_in [mm]."""
        x_in = np.zeros_like(time_s)
        for A, omega, phi in self.sines:
            x_in += A * (np.sin(omega * time_s + phi) - np.sin(phi))
        return x_in

    def motion(self, time_s: float) -> tuple[float, float, float]:
        """Return x_in [mm], v_in [mm/s] and a_in [mm/s²]."""
        A, omega, phi = self.tables().sines.T
        phase = omega * time_s + phi
        x = A * (np.sin(phase) - np.sin(phi))
        v, a = A * omega * np.cos(phase), -A * omega**2 * np.sin(phase)
        return float(x.sum()), float(v.sum()), float(a.sum())

    def tables(self) -> Tables:
        """Return the drive for compiled code."""
        return Tables(np.array(self.sines), NO_PIECES)

    def record(self) -> dict[str, Any]:
        """Return the parameters."""
        return {"sines": [sine._asdict() for sine in self.sines]}


@dataclass(frozen=True)
class Samples:
    """Samples at a fixed rate from t = 0 on, joined by monotone cubics (C1)."""

    x_in_mm: tuple[float, ...]
    rate_Hz: float = 1000.0

    def position(self, time_s: Floats) -> Floats:
        """Return x_in [mm]."""
        return self._cubics(time_s)

    def motion(self, time_s: float) -> tuple[float, float, float]:
        """Return x_in [mm], v_in [mm/s] and a_in [mm/s²]."""
        x, v, a = (float(self._cubics(time_s, derivative)) for derivative in range(3))
        return x, v, a

    def tables(self) -> Tables:
        """Return the drive for compiled code."""
        cubics = self._cubics
        pieces = np.column_stack([cubics.x[:-1], cubics.c.T])
        return Tables(NO_SINES, np.ascontiguousarray(pieces))

    def record(self) -> dict[str, Any]:
        """Return what is known beside the samples."""
        return {"samples": len(self.x_in_mm), "rate_Hz": self.rate_Hz}

    @cached_property
    def _cubics(self) -> PchipInterpolator:
        return PchipInterpolator(np.arange(len(self.x_in_mm)) / self.rate_Hz, self.x_in_mm)


def noisy(sines: Sines, *, seconds: float, noise_mm: float = 0.01, seed: int = 1) -> Samples:
    """Return samples at 1 kHz with Gaussian noise; the first one is exactly zero."""
    time_s = np.arange(round(1000 * seconds) + 1) / 1000.0
    x_in = sines.position(time_s)
    x_in[1:] += noise_mm * np.random.default_rng(seed).standard_normal(x_in.size - 1)
    return Samples(tuple(x_in.tolist()))
