"""A wave over a position, zero at the origin: the first harmonic of what turns off its centre."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


class Wave(NamedTuple):
    """Two amplitudes of the wave, and its period in travel [mm]."""

    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    period_mm: float = 10.0

    @property
    def is_flat(self) -> bool:
        """Whether both amplitudes are zero."""
        return self.sine_mm == self.cosine_mm == 0.0


@kernel
def wave_at(position: Values, wave: Wave) -> tuple[Values, Values]:
    """Return sine·sin a + cosine·(cos a − 1) [mm] with a = 2π position/period, and its slope."""
    rate = 2.0 * math.pi / wave.period_mm
    angle = rate * position
    up, along = np.sin(angle), np.cos(angle)
    slope = rate * (wave.sine_mm * along - wave.cosine_mm * up)
    return wave.sine_mm * up + wave.cosine_mm * (along - 1.0), slope


@kernel
def rippled(position: Values, wave: Wave) -> Values:
    """Return a position with the wave on it [mm]."""
    return position + wave_at(position, wave)[0]


def periods(longest: float, shortest: float, number: int) -> tuple[float, ...]:
    """Return periods of equally spaced frequencies, the longest first."""
    return tuple(1.0 / f for f in np.linspace(1.0 / longest, 1.0 / shortest, number).tolist())
