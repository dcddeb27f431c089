"""What the friction in the sheath depends on, beyond Coulomb's law."""

from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.courses import settled
from tsas_studies.challenge.rig.motions import Floats


class Friction(NamedTuple):
    """How friction differs by direction, speed, tension and time; all zeros are Coulomb's law."""

    # Friction is μ (1 ± asymmetry) where the tendon slides towards (+) or from the drive (−).
    asymmetry: float = 0.0
    # It is μ (1 + excess · exp(−(v/velocity)^power)) where the tendon slides at v; each place has
    # its own speed and forgets the one before within the memory.
    stribeck_excess: float = 0.0
    stribeck_velocity_mm_per_s: float = 5.0
    stribeck_power: float = 2.0
    stribeck_memory_s: float = 0.02
    load_exponent: float = 0.0  # it is μ (T/10 N)^exponent at each place
    # Force per speed of the tendon as a whole; each place has its own speed.
    viscous_N_s_per_mm: float = 0.0
    drag_N: float = 0.0  # of the whole sheath, even along it, the same at any tension
    # Displacement over which friction reverses, beyond the rig's own; the work lost until it has
    # turned is that of a friction that changes by its limit per such displacement.
    presliding_mm: float = 0.0
    presliding_growth: float = 0.0  # part of it that is in proportion to the tension, as at 10 N
    # μ grows over a run, relative to its first value, and over the session.
    rate_per_s: float = 0.0
    settling_per_s: float = 0.0
    session_rate_per_s: float = 0.0
    bend_rate_rad_per_s: float = 0.0  # at which the total bend grows over a run
    bend_settling_per_s: float = 0.0
    # μ grows by so much per displacement of the drive, relative to that at x_in = 0.
    slope_per_mm: float = 0.0
    # μ at the load's end of the sheath less that at the drive's, relative to their mean.
    slope_along: float = 0.0
    # μ goes up and down with a temperature, 1 + share · sin(2πt/period + phase).
    cycle_share: float = 0.0
    cycle_s: float = 5.0
    cycle_phase_rad: float = 0.0
    wear_per_mm: float = 0.0  # μ grows by so much per travel of the drive
    # Presliding of Bouc and Wen in place of Dahl's, with this length beside the rig's own.
    round_mm: float = 0.0
    # The sheath shifts under load: its bend grows by so much per newton of tension at the drive.
    shift_per_N: float = 0.0


def over_time(friction: Friction, total_bend_rad: float, t: Floats, session_s: float) -> Floats:
    """Return the factor on μ at each time of a run that begins session_s after the first."""
    f = friction
    worn = 1.0 + settled(f.rate_per_s, f.settling_per_s, t) + f.session_rate_per_s * session_s
    bend = total_bend_rad + settled(f.bend_rate_rad_per_s, f.bend_settling_per_s, t)
    cycle = 1.0 + f.cycle_share * np.sin(2.0 * np.pi * t / f.cycle_s + f.cycle_phase_rad)
    return np.maximum(worn, 0.0) * (np.maximum(bend, 0.0) / total_bend_rad) * cycle


def over_travel(friction: Friction, x_in: Floats) -> Floats:
    """Return the factor on μ for each position of the drive [mm] and the travel until then."""
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x_in)))))
    there = 1.0 + friction.slope_per_mm * x_in
    return np.asarray(np.maximum(there, 0.0) * (1.0 + friction.wear_per_mm * travel))
