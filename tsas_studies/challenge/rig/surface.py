"""How the friction of one place in the sheath depends on its speed, its rest and where it is.

Each law is a factor on the friction coefficient, and all factors of a place are multiplied. None
is in the catalogue of effects; they are other laws that are found in sheaths. All follow the
speeds and displacements of the step before.
"""

from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled

RESTS_MM_S = 0.05  # below which a place counts as resting


class Surface(NamedTuple):
    """Laws of friction by place beside those of `Friction`; all shares and excesses 0 are none."""

    # Stribeck friction with a long tail, 1 + excess / (1 + (v/velocity)^power).
    rational_excess: float = 0.0
    rational_velocity_mm_per_s: float = 5.0
    rational_power: float = 1.0
    # Stribeck friction with a sharp peak, 1 + excess · exp(−(v/velocity)^½).
    root_excess: float = 0.0
    root_velocity_mm_per_s: float = 5.0
    # Friction that grows with the logarithm of the speed, 1 + share · ln(1 + v/velocity).
    log_share: float = 0.0
    log_velocity_mm_per_s: float = 1.0
    # Contacts age, 1 + share · ln(1 + θ/time) with dθ/dt = 1 − vθ/length (Dieterich 1979).
    ageing_share: float = 0.0
    ageing_s: float = 0.1
    ageing_mm: float = 0.2
    # A place that has rested sticks, 1 + excess · exp(−s/length) after sliding by s.
    breakaway_excess: float = 0.0
    breakaway_mm: float = 0.5
    # Strands roll over the liner, 1 + share · sin(2πu/period + phase), u the displacement.
    roll_share: float = 0.0
    roll_mm: float = 5.0
    roll_phase_rad: float = 0.0


class Past(NamedTuple):
    """What one place remembers: speed [mm/s], age of its contacts [s], slid since a rest [mm]."""

    speed: float
    age: float
    slid: float


@compiled
def remembered(past: Past, du: float, h: float, forgotten: float, law: Surface) -> Past:
    """Return the past of a place after it has gone by du [mm] within h seconds.

    `forgotten` is the share of its former speed that it forgets meanwhile.
    """
    speed = past.speed + forgotten * (abs(du) / h - past.speed)
    renewed = np.exp(-abs(du) / law.ageing_mm)
    slid = 0.0 if speed < RESTS_MM_S else past.slid + abs(du)
    return Past(speed, past.age * renewed + h, slid)


@compiled
def roughness(past: Past, u: float, law: Surface) -> float:
    """Return the factor on the friction of a place at displacement u [mm]."""
    v, factor = past.speed, 1.0
    if law.rational_excess != 0.0:
        tail = (v / law.rational_velocity_mm_per_s) ** law.rational_power
        factor *= 1.0 + law.rational_excess / (1.0 + tail)
    if law.root_excess != 0.0:
        factor *= 1.0 + law.root_excess * np.exp(-np.sqrt(v / law.root_velocity_mm_per_s))
    if law.log_share != 0.0:
        factor *= 1.0 + law.log_share * np.log(1.0 + v / law.log_velocity_mm_per_s)
    if law.ageing_share != 0.0:
        factor *= 1.0 + law.ageing_share * np.log(1.0 + past.age / law.ageing_s)
    if law.breakaway_excess != 0.0:
        factor *= 1.0 + law.breakaway_excess * np.exp(-past.slid / law.breakaway_mm)
    if law.roll_share != 0.0:
        turn = 2.0 * np.pi * u / law.roll_mm + law.roll_phase_rad
        factor *= 1.0 + law.roll_share * np.sin(turn)
    return float(factor)
