"""A wave over a position, zero at the origin: two harmonics of what turns off its centre."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values

DISTANT = 10.0  # periods


class Wave(NamedTuple):
    """Two amplitudes of the wave, its period in travel [mm], and its second harmonic.

    The amplitudes of the second harmonic are shares of that of the first [1].
    """

    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    period_mm: float = 10.0
    second_sine: float = 0.0
    second_cosine: float = 0.0

    @property
    def is_flat(self) -> bool:
        """Whether both amplitudes are zero."""
        return self.sine_mm == self.cosine_mm == 0.0

    @property
    def reach_mm(self) -> float:
        """What the wave adds to a position, at most [mm]."""
        share = abs(self.second_sine) + 2.0 * abs(self.second_cosine)
        first = abs(self.sine_mm) + 2.0 * abs(self.cosine_mm)
        return first + share * math.hypot(self.sine_mm, self.cosine_mm)


@kernel
def wave_at(position: Values, wave: Wave) -> tuple[Values, Values]:
    """Return the wave [mm] and its slope.

    It is s sin a + c (cos a − 1) + r (p sin 2a + q (cos 2a − 1)), with a = 2π position/period,
    r² = s² + c².
    """
    rate = 2.0 * math.pi / wave.period_mm
    angle = rate * position
    up, along = np.sin(angle), np.cos(angle)
    slope = rate * (wave.sine_mm * along - wave.cosine_mm * up)
    value = wave.sine_mm * up + wave.cosine_mm * (along - 1.0)
    if wave.second_sine != 0.0 or wave.second_cosine != 0.0:
        size = math.sqrt(wave.sine_mm**2 + wave.cosine_mm**2)
        up, along = 2.0 * up * along, 1.0 - 2.0 * up * up
        value += size * (wave.second_sine * up + wave.second_cosine * (along - 1.0))
        slope += 2.0 * rate * size * (wave.second_sine * along - wave.second_cosine * up)
    return value, slope


@kernel
def rippled(position: Values, wave: Wave) -> Values:
    """Return a position with the wave on it [mm]."""
    return position + wave_at(position, wave)[0]


@kernel
def wave_from(wave: Wave, origin_mm: float) -> Wave:
    """Return the wave over the distance from an origin, but for a constant.

    It is the same one for a distant origin, as of an encoder that nobody has set to zero: a phase
    so many periods away depends on the period more than a fit begins to know it.
    """
    if wave.sine_mm == wave.cosine_mm == 0.0 or abs(origin_mm) > DISTANT * wave.period_mm:
        return wave
    angle = 2.0 * math.pi * origin_mm / wave.period_mm
    sine, cosine = _turned(wave.sine_mm, wave.cosine_mm, angle)
    second_sine, second_cosine = _turned(wave.second_sine, wave.second_cosine, 2.0 * angle)
    return Wave(sine, cosine, wave.period_mm, second_sine, second_cosine)


@kernel
def _turned(sine: float, cosine: float, angle: float) -> tuple[float, float]:
    """Return the amplitudes of a wave whose phase is larger by an angle."""
    up, along = math.sin(angle), math.cos(angle)
    return sine * along - cosine * up, sine * up + cosine * along


def periods(longest: float, shortest: float, number: int) -> tuple[float, ...]:
    """Return periods of equally spaced frequencies, the longest first."""
    return tuple(1.0 / f for f in np.linspace(1.0 / longest, 1.0 / shortest, number).tolist())
