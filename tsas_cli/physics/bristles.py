"""Friction at one node of the tendon with pre-sliding: LuGre's bristles.

Yang 2025, Eq. (15): the deflection z of the bristles follows dz/dt = v − |v| z/z∞, and friction is
f = g z/z∞ + σ1 dz/dt + σ2 v. Its limit is g; z∞ = g/σ0 + l, where l is the part of the travel of
Dahl's law (`presliding`) that does not depend on the tension; the other is in series with σ0. With
l = 0 that is σ0 z in the first term.
"""

import math
from typing import NamedTuple

from tsas_cli.numerics.compiled import kernel

TONNES_PER_KG = 1e-3
TONNES_PER_MM = 1e-6  # of kg/m


class Bristles(NamedTuple):
    """The constants of the dynamic model, of the whole sheath (Table 1 of Yang 2025, 50 lumps).

    A damping of NaN stands for critical damping.
    """

    stiffness_N_per_mm: float = 5000.0  # [σ0 n]
    damping_N_s_per_mm: float = math.nan  # [σ1 n]; the paper's 15.8 is 80 times critical
    tendon_mass_kg_per_m: float = 0.0025  # [ρ]
    tendon_damping_N_s_per_mm: float = 0.002  # [c/n]


class Bristle(NamedTuple):
    """The constants of one node."""

    stiffness: float  # [N/mm]
    damping: float  # [N s/mm]
    viscous: float  # [N s/mm]
    travel: float  # of Dahl's law, at any tension [mm]


@kernel
def tendon_mass(bristles: Bristles, length_mm: float) -> float:
    """Return the mass of the tendon in the sheath [t]."""
    return bristles.tendon_mass_kg_per_m * TONNES_PER_MM * length_mm


@kernel
def bristle_damping(bristles: Bristles, length_mm: float, limit_N: float, travel: float) -> float:
    """Return σ1 of the whole sheath [N s/mm], by default 2 √(k m).

    k is the stiffness of the bristles at the preload: σ0 in series with limit/travel.
    """
    if not math.isnan(bristles.damping_N_s_per_mm):
        return bristles.damping_N_s_per_mm
    stiffness = bristles.stiffness_N_per_mm
    if limit_N > 0.0:  # a straight sheath has no friction
        stiffness = limit_N / (limit_N / bristles.stiffness_N_per_mm + travel)
    return 2.0 * math.sqrt(stiffness * tendon_mass(bristles, length_mm))


@kernel
def friction(
    before: float, speed: float, step: float, limit: float, bristle: Bristle
) -> tuple[float, float, float, float]:
    """Return friction, its derivatives by speed and by its limit, and the deflection.

    The deflection is that after an implicit step: z = Z + h (v − |v| z/z∞), with Z (`before`) and
    h (`step`) of the integration formula.
    """
    direction = 1.0 if speed >= 0.0 else -1.0
    steady = limit / bristle.stiffness + bristle.travel
    inverse = 1.0 / (steady + step * speed * direction)
    share = (before + step * speed) * inverse
    damping = bristle.damping / step
    force = limit + damping * steady
    by_share = force * inverse
    by_speed = by_share * step * (1.0 - direction * share) + bristle.viscous
    by_limit = share + (damping * share - by_share * share) / bristle.stiffness
    total = force * share - damping * before + bristle.viscous * speed
    return total, by_speed, by_limit, steady * share


@kernel
def friction_now(
    deflection: float, speed: float, limit: float, bristle: Bristle
) -> tuple[float, float]:
    """Return friction and the rate of the deflection at a moment, Yang 2025, Eq. (15)."""
    steady = limit / bristle.stiffness + bristle.travel
    rate = speed - abs(speed) * deflection / steady
    return limit * deflection / steady + bristle.damping * rate + bristle.viscous * speed, rate
