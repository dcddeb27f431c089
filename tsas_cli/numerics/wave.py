"""A wave over a position, zero at the origin: the first harmonic of what turns off its centre."""

import math

import numpy as np

from tsas_cli.numerics.compiled import kernel


@kernel
def wave_at(position: float, sine: float, cosine: float, period: float) -> tuple[float, float]:
    """Return sine·sin a + cosine·(cos a − 1) with a = 2π position/period, and its slope."""
    rate = 2.0 * math.pi / period
    angle = rate * position
    up: float = np.sin(angle)
    along: float = np.cos(angle)
    return sine * up + cosine * (along - 1.0), rate * (sine * along - cosine * up)


def periods(longest: float, shortest: float, number: int) -> tuple[float, ...]:
    """Return periods of equally spaced frequencies, the longest first."""
    return tuple(1.0 / f for f in np.linspace(1.0 / longest, 1.0 / shortest, number).tolist())
