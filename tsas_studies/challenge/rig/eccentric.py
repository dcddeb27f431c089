"""What turns off its centre, or is oval: two harmonics over a position, by complex amplitudes."""

from typing import Any

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled


@compiled
def eccentric(
    at: Any, sine: float, cosine: float, period: float, second_sine: float, second_cosine: float
) -> tuple[Any, Any]:
    """Return the wave at a position or an array of them, zero at the origin, and its slope.

    It is the real part of first · (e^iφ − 1) + |first| second · (e^2iφ − 1), φ = 2π at/period: an
    amplitude is the cosine's less i times the sine's. Those of the second harmonic are shares.
    """
    first, second = complex(cosine, -sine), complex(second_cosine, -second_sine)
    turn = 2.0 * np.pi / period
    once = np.exp(1j * turn * at)
    size = abs(first) * second
    value = first * (once - 1.0) + size * (once * once - 1.0)
    slope = 1j * turn * (first * once + 2.0 * size * once * once)
    return value.real, slope.real
