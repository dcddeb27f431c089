"""The static model in closed form: tensions, elongations and stiffnesses of the four phases.

Yang 2025, Eqs. (1)-(9) and (26)-(34). Symbols: a = μθ, EA the tendon's axial stiffness, L the
sheath's length, kL the load spring, λ = +1 in contraction and −1 in loosening.
"""

import math

from tsas_cli.numerics.compiled import kernel


@kernel
def tension_ratio(wrap: float, direction: float) -> float:
    """Return F(L)/F(0) = exp(−λ a) while the whole tendon slips, Eq. (7)."""
    return math.exp(-direction * wrap)


@kernel
def mean_tension_ratio(wrap: float, direction: float) -> float:
    """Return the mean of F(s)/F(0) over the sheath, (1 − e^(−λa))/(λa), from Eq. (8)."""
    exponent = direction * wrap
    return -math.expm1(-exponent) / exponent if exponent != 0.0 else 1.0


@kernel
def slip_stiffness(
    wrap: float, direction: float, load_stiffness: float, length: float, tendon_stiffness: float
) -> float:
    """Return km = dFin/dxin [N/mm] in full slip with the elastic term kept, Eq. (30).

    Without that term it is `load_stiffness * exp(direction * wrap)`, Eqs. (31) and (32).
    """
    ratio = tension_ratio(wrap, direction)
    elastic = mean_tension_ratio(wrap, direction) * length / tendon_stiffness
    return 1.0 / (ratio / load_stiffness + elastic)


@kernel
def dead_band_stiffness(wrap: float, length: float, tendon_stiffness: float) -> float:
    """Return the secant stiffness km of a whole dead band [N/mm], Eq. (29)."""
    return tendon_stiffness * wrap / (length * math.tanh(0.5 * wrap))


@kernel
def dead_band_width(tension: float, wrap: float, length: float, tendon_stiffness: float) -> float:
    """Return the drive's travel in a dead band at a distal tension, from Eqs. (27)-(29) [mm]."""
    swing = 4.0 * math.sinh(0.5 * wrap) ** 2  # e^a + e^-a − 2
    return tension * swing * length / (wrap * tendon_stiffness)


@kernel
def speed_per_stiffness(radius: float, gear_ratio: float) -> float:
    """Return kr/km = 2π r1/(60 im), the drive's mm/s per rpm of the motor, Eqs. (25) and (34)."""
    return 2.0 * math.pi * radius / (60.0 * gear_ratio)
