"""The load's end: guide, force sensor, spring, mass, all moving with x_out.

From the tendon to the ground: friction before the sensor, the sensor f_out, friction after it,
then side by side the mass, the spring and a stop. The linear part of the spring is in the equation
of the tendon's last node; what is here adds to it.
"""

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from tsas_cli.challenge.rig.compiled import compiled
from tsas_cli.challenge.rig.dahl import dahl, dahl_slope

PRESLIDING_MM = 1e-4
TONNE_PER_KG = 1e-3
# Newmark's method, second order but for a little damping of what the clock cannot follow.
BETA, GAMMA = 0.3025, 0.6


@dataclass(frozen=True)
class LoadEnd:
    """What the load is made of beside its linear spring; all zeros are none of it.

    Attributes
    ----------
    quadratic_per_mm, cubic_per_mm2
        The spring's force is F0 + kL x (1 + quadratic x + cubic x²).
    friction_after_N, friction_before_N
        Coulomb friction of the guide on the load's and on the tendon's side of the sensor.
    mass_kg
        What moves with the load.
    stop_at_mm, stop_N_per_mm
        A stop with a stiffness, met when x_out exceeds its place.
    anchor_rate_N_per_s, anchor_settling_per_s
        The spring's anchor gives way: so fast its force falls, and how fast that settles.
    """

    quadratic_per_mm: float = 0.0
    cubic_per_mm2: float = 0.0
    friction_after_N: float = 0.0
    friction_before_N: float = 0.0
    mass_kg: float = 0.0
    stop_at_mm: float = inf
    stop_N_per_mm: float = 0.0
    anchor_rate_N_per_s: float = 0.0
    anchor_settling_per_s: float = 0.0


class Load(NamedTuple):
    """The load in units of the solver: N, mm, tonne."""

    quadratic: float
    cubic: float
    friction: float
    mass: float
    stop_at: float
    stop: float


class LoadState(NamedTuple):
    """Position [mm], speed [mm/s] and acceleration [mm/s²] of the load; state of its guide."""

    y: float
    v: float
    a: float
    guide: float


def load(end: LoadEnd, stiffness_N_per_mm: float) -> Load:
    """Return the load for the solver."""
    return Load(
        quadratic=stiffness_N_per_mm * end.quadratic_per_mm,
        cubic=stiffness_N_per_mm * end.cubic_per_mm2,
        friction=end.friction_after_N + end.friction_before_N,
        mass=end.mass_kg * TONNE_PER_KG,
        stop_at=end.stop_at_mm,
        stop=end.stop_N_per_mm,
    )


@compiled
def moved(before: LoadState, y: float, h: float) -> LoadState:
    """Return the state after the load has gone to y within h seconds."""
    a = _acceleration(before, y, h)
    v = before.v + h * ((1.0 - GAMMA) * before.a + GAMMA * a)
    return LoadState(y, v, a, dahl(y - before.y, before.guide, PRESLIDING_MM, 0.0, 1.0))


@compiled
def extra_force(load: Load, before: LoadState, y: float, h: float) -> tuple[float, float]:
    """Return the force beside the linear spring's [N] at y, and its slope [N/mm]."""
    dy = y - before.y
    force = (load.quadratic + load.cubic * y) * y * y
    slope = (2.0 * load.quadratic + 3.0 * load.cubic * y) * y
    force += load.friction * dahl(dy, before.guide, PRESLIDING_MM, 0.0, 1.0)
    slope += load.friction * dahl_slope(dy, before.guide, PRESLIDING_MM, 0.0, 1.0)
    force += load.mass * _acceleration(before, y, h)
    slope += load.mass / (BETA * h * h)
    if y > load.stop_at:
        force += load.stop * (y - load.stop_at)
        slope += load.stop
    return force, slope


@compiled
def _acceleration(before: LoadState, y: float, h: float) -> float:
    gone = y - before.y - h * before.v - h * h * (0.5 - BETA) * before.a
    return gone / (BETA * h * h)
