"""The load's end: guide, force sensor, spring, mass, all moving with x_out.

From the tendon to the ground: friction before the sensor, the sensor f_out, friction after it,
then side by side the mass, the spring and a stop. The linear part of the spring is in the equation
of the tendon's last node; what is here adds to it.
"""

from math import inf
from typing import NamedTuple

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl, dahl_slope
from tsas_studies.challenge.rig.restraint import (
    Restraint,
    RestraintState,
    Spring,
    held,
    restrained,
)

PRESLIDING_MM = 1e-4
TONNE_PER_KG = 1e-3
# Newmark's method, second order but for a little damping of what the clock cannot follow.
BETA, GAMMA = 0.3025, 0.6
LOOSE_S = 0.015  # in which a loose part of the mass takes up the load's speed


class LoadEnd(NamedTuple):
    """What the load is made of beside its linear spring; all zeros are none of it."""

    # The spring's force is F0 + kL x (1 + quadratic x + cubic x²).
    quadratic_per_mm: float = 0.0
    cubic_per_mm2: float = 0.0
    # Coulomb friction of the guide on the load's and on the tendon's side of the sensor.
    friction_after_N: float = 0.0
    friction_before_N: float = 0.0
    mass_kg: float = 0.0  # what moves with the load
    # The share of it that a damper carries along: without one a load on a tendon swings long.
    loose_share: float = 0.0
    stop_at_mm: float = inf  # place of a stop, met when x_out exceeds it
    stop_N_per_mm: float = 0.0  # its stiffness
    # The spring's anchor gives way: so fast its force falls, and how fast that settles.
    anchor_rate_N_per_s: float = 0.0
    anchor_settling_per_s: float = 0.0


class Load(NamedTuple):
    """The load in the solver."""

    end: LoadEnd
    restraint: Restraint
    spring: Spring


class LoadState(NamedTuple):
    """Position [mm], speed [mm/s] and acceleration [mm/s²] of the load, speed of its loose part.

    Beside them the friction state of the guide, and the state of what else holds it back.
    """

    y: float
    v: float
    a: float
    v_loose: float
    guide: float
    restraint: RestraintState


AT_REST = LoadState(0.0, 0.0, 0.0, 0.0, 0.0, RestraintState(0.0, 0.0, 0.0))


@compiled
def moved(load: Load, before: LoadState, y: float, h: float) -> LoadState:
    """Return the state after the load has gone to y within h seconds."""
    a, v = _newmark(before, y, h)
    v_loose = before.v_loose + _taken_up(before, v, h) * h
    dy = y - before.y
    guide = dahl(dy, before.guide, PRESLIDING_MM, 0.0, 1.0)
    state = held(load.restraint, load.spring, before.restraint, y, dy, h)
    return LoadState(y, v, a, v_loose, guide, state)


@compiled
def extra_force(load: Load, before: LoadState, y: float, h: float) -> tuple[float, float]:
    """Return the force beside the linear spring's [N] at y, and its slope [N/mm]."""
    end, k, dy = load.end, load.spring.stiffness_N_per_mm, y - before.y
    quadratic, cubic = k * end.quadratic_per_mm, k * end.cubic_per_mm2
    force = (quadratic + cubic * y) * y * y
    slope = (2.0 * quadratic + 3.0 * cubic * y) * y
    friction = end.friction_after_N + end.friction_before_N
    force += friction * dahl(dy, before.guide, PRESLIDING_MM, 0.0, 1.0)
    slope += friction * dahl_slope(dy, before.guide, PRESLIDING_MM, 0.0, 1.0)
    a, v = _newmark(before, y, h)
    mass = end.mass_kg * TONNE_PER_KG * (1.0 - end.loose_share)
    loose = end.mass_kg * TONNE_PER_KG * end.loose_share
    force += mass * a + loose * _taken_up(before, v, h)
    slope += mass / (BETA * h * h) + loose * GAMMA / (BETA * h * (LOOSE_S + h))
    if y > end.stop_at_mm:
        force += end.stop_N_per_mm * (y - end.stop_at_mm)
        slope += end.stop_N_per_mm
    more, steeper = restrained(load.restraint, load.spring, before.restraint, y, dy, h)
    return force + more, slope + steeper


@compiled
def _newmark(before: LoadState, y: float, h: float) -> tuple[float, float]:
    """Return acceleration and speed after the load has gone to y within h seconds."""
    gone = y - before.y - h * before.v - h * h * (0.5 - BETA) * before.a
    a = gone / (BETA * h * h)
    return a, before.v + h * ((1.0 - GAMMA) * before.a + GAMMA * a)


@compiled
def _taken_up(before: LoadState, v: float, h: float) -> float:
    """Return the acceleration of the loose part [mm/s²] by an implicit Euler step."""
    return (v - before.v_loose) / (LOOSE_S + h)
