"""The dynamic chain before its first step: the laws of a rig, its segments, nodes at rest."""

import math

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import Boundary
from tsas_cli.physics.bristles import Bristle, bristle_damping, tendon_mass
from tsas_cli.physics.lugre.balance import balance, set_limits
from tsas_cli.physics.lugre.ends import StepEnds, ends_after
from tsas_cli.physics.lugre.input import DRIVE, step_at, value_at
from tsas_cli.physics.lugre.state import (
    DAMPING,
    DEFLECTION,
    DEFLECTION_HISTORY,
    LIMIT,
    POSITION,
    POSITION_HISTORY,
    RATE,
    RESIDUAL,
    ROWS,
    SPEED,
    SPEED_HISTORY,
    STIFFNESS,
    TENSION_HISTORY,
    TENSION_SLOPE,
    Floats,
    LugreLaws,
    Step,
)
from tsas_cli.physics.lugre.step import bdf2
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig

NO_TIME_S = 1e-13  # step of the balance at rest


@kernel
def lugre_laws(rig: Rig, n: int) -> LugreLaws:
    """Return what of the rig holds at every step."""
    effects, bristles = rig.effects, rig.bristles
    stiffness = bristles.stiffness_N_per_mm
    travel = effects.presliding.length_mm
    limit = rig.preload_N * rig.friction_coefficient * rig.total_bend_rad
    damping = bristle_damping(bristles, rig.sheath_length_mm, limit, travel)
    viscous = effects.viscous_friction.coefficient_N_s_per_mm / n
    return LugreLaws(
        n,
        rig.preload_N,
        tendon_mass(bristles, rig.sheath_length_mm) / n,
        Bristle(stiffness / n, damping / n, viscous, travel),
        Bristle(stiffness, damping, 0.0, 0.0),
        effects.load_dependent_friction.exponent,
        effects.stribeck_friction,
        rig.load_stiffness_N_per_mm,
        effects.load_spring_nonlinearity,
        effects.load_friction,
        effects.load_inertia.mass_kg,
        effects.drive_friction.friction_N,
        effects.proximal_spring.stiffness_N_per_mm,
    )


@kernel
def segments(rig: Rig, n: int) -> tuple[Floats, Floats]:
    """Return stiffness and damping of the n + 1 segments [N/mm, N s/mm]."""
    stiffness = 1.0 / segment_compliances(rig, n)
    relaxation_s = rig.bristles.tendon_damping_N_s_per_mm * rig.sheath_length_mm
    return stiffness, relaxation_s / rig.tendon_stiffness_N * stiffness


@kernel
def clear_state(s: Floats, rig: Rig, n: int) -> None:
    """Set the tendon's segments, and everything else to zero."""
    for row in range(ROWS):
        for i in range(n + 2):
            s[PITCH * row + i] = 0.0
    set_segments(s, rig, n)


@kernel
def set_segments(s: Floats, rig: Rig, n: int) -> None:
    """Set stiffness and damping of the tendon's segments."""
    stiffness, damping = segments(rig, n)
    for j in range(n + 1):
        s[STIFFNESS + j], s[DAMPING + j] = stiffness[j], damping[j]


@kernel
def start_at_rest(
    s: Floats,
    start: Floats,
    times: Floats,
    course: Floats,
    k: int,
    t: float,
    boundary: Boundary,
    law: LugreLaws,
) -> StepEnds:
    """Lay the nodes down at rest at a time from sample k to the next; see `lay_down`."""
    drive = value_at(times, course, DRIVE, k, t)[0]
    formula = bdf2(NO_TIME_S, math.inf, math.inf)
    step = step_at(times, course, k, t, formula, (drive, drive), law.n, boundary)
    return rest_at(s, start, step, boundary, law)


@kernel
def rest_at(s: Floats, start: Floats, step: Step, boundary: Boundary, law: LugreLaws) -> StepEnds:
    """Lay the nodes down at rest, their bristles holding what the tensions leave over.

    `start` holds positions and tensions, shape (2, n + 2) [mm, N], and `step`, of no time, what is
    given; returns the ends.
    """
    last = law.n + 1
    for i in range(law.n + 2):
        s[POSITION + i] = s[POSITION_HISTORY + i] = start[0, i] - step.position
        s[TENSION_HISTORY + i], s[TENSION_SLOPE + i] = start[1, i], 0.0
        s[SPEED + i] = s[SPEED_HISTORY + i] = s[RATE + i] = s[DEFLECTION_HISTORY + i] = 0.0
    balance(s, step, boundary, law)
    for i in range(1, law.n + 1):
        s[DEFLECTION_HISTORY + i] = s[
            RESIDUAL + i
        ]  # the side to which it leans: each has a limit of its own
    set_limits(s, step, law)
    for i in range(1, law.n + 1):
        share = min(max(s[RESIDUAL + i] / s[LIMIT + i], -1.0), 1.0)
        s[DEFLECTION + i] = s[RESIDUAL + i] / law.bristle.stiffness + share * law.bristle.travel
    s[DEFLECTION] = s[RESIDUAL] / law.end_bristle.stiffness
    s[DEFLECTION + last] = s[RESIDUAL + last] / law.end_bristle.stiffness
    return ends_after(s, step, law)
