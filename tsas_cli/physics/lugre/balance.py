"""Residual forces of the lumps and their derivatives by the speeds: Newton's equations.

Each lump: m dv/dt = T before − T behind − f (Yang 2025, Eqs. 10 to 14), f by `bristles` with the
limit g = μ N, N by the mean of both tensions (Eq. 17; 2 tanh(μθ/2n) for its sine, so that the
tension ratio over a sliding lump is e^(−μθ/n), Eq. 7), and the sheath's drag. The ends have no
mass: their forces balance. The residual depends on the speeds of a node and its two neighbours: the
Jacobian is tridiagonal.
"""

import math

from tsas_cli.effects.drive_damping import drive_damper_force
from tsas_cli.effects.drive_inertia import drive_inertia_force
from tsas_cli.effects.load_damping import load_damper_force
from tsas_cli.effects.load_dependent_friction import load_factor
from tsas_cli.effects.load_hysteresis import element_force
from tsas_cli.effects.load_inertia import inertia_force
from tsas_cli.effects.load_relaxation import relaxing_force
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.effects.stribeck_friction import stribeck
from tsas_cli.effects.uneven_friction import place_factor
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, moving_friction, spring_law
from tsas_cli.physics.bristles import friction
from tsas_cli.physics.lugre import state as at
from tsas_cli.physics.lugre.input import lump_share
from tsas_cli.physics.lugre.state import LugreLaws, Step
from tsas_cli.support.arrays import Floats

LEAST_LIMIT_N = 1e-9  # at zero tension, so that a bristle has a limit at all


@kernel
def balance(s: Floats, step: Step, laws: LugreLaws) -> float:
    """Set up Newton's equations at the present rates; return the sum of the residual forces [N]."""
    set_tensions(s, laws)
    set_limits(s, step, laws)
    balance_lumps(s, step, laws)
    balance_drive(s, step, laws)
    balance_load(s, step, laws)
    return residual_sum(s, laws.n + 2)


@kernel
def residual_sum(s: Floats, count: int) -> float:
    """Return the sum of |RESIDUAL|, by four independent sums: one alone waits for each addition."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = count - count % 4
    for i in range(0, whole, 4):
        a += abs(s[at.RESIDUAL + i])
        b += abs(s[at.RESIDUAL + i + 1])
        c += abs(s[at.RESIDUAL + i + 2])
        d += abs(s[at.RESIDUAL + i + 3])
    for i in range(whole, count):
        a += abs(s[at.RESIDUAL + i])
    return a + b + c + d


@kernel
def set_tensions(s: Floats, laws: LugreLaws) -> None:
    """Set the segments' tensions, Yang 2025, Eq. (11)."""
    for j in range(laws.n + 1):
        s[at.TENSION + j] = s[at.TENSION_HISTORY + j] + s[at.TENSION_SLOPE + j] * (
            s[at.RATE + j] - s[at.RATE + j + 1]
        )


@kernel
def set_limits(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set the limits of the lumps' friction and their derivatives, Yang 2025, Eqs. (16) to (19)."""
    for i in range(1, laws.n + 1):
        mean = 0.5 * (s[at.TENSION + i - 1] + s[at.TENSION + i])
        deflected = s[at.DEFLECTION_HISTORY + i] + step.gh * (s[at.RATE + i] + step.frame.rate)
        factor = step.pulled if deflected >= 0.0 else step.released
        factor = factor if mean >= 0.0 else -factor
        s[at.LIMIT + i] = factor * mean + LEAST_LIMIT_N
        s[at.LIMIT_BY_T + i] = factor
        s[at.LIMIT_BY_V + i] = 0.0
    if laws.lump.friction_exponent != 0.0:
        for i in range(1, laws.n + 1):
            mean = 0.5 * (s[at.TENSION + i - 1] + s[at.TENSION + i])
            factor = load_factor(mean, laws.lump.friction_exponent)
            s[at.LIMIT + i] *= factor
            s[at.LIMIT_BY_T + i] *= factor * (1.0 + laws.lump.friction_exponent)
    if laws.lump.friction_slope != 0.0:
        for i in range(1, laws.n + 1):
            factor = place_factor((i - 0.5) / laws.n, laws.lump.friction_slope)
            s[at.LIMIT + i] *= factor
            s[at.LIMIT_BY_T + i] *= factor
    if laws.lump.stribeck.excess != 0.0:
        set_stribeck(s, step, laws)
    add_pulley(s, 1, laws.pulleys.drive_loss)
    add_pulley(s, laws.n, laws.pulleys.load_loss)
    for i in range(1, laws.n + 1):
        s[at.LIMIT + i] += laws.lump.drag_N


@kernel
def add_pulley(s: Floats, i: int, loss: float) -> None:
    """Add the friction of a pulley to the limit of a lump."""
    if loss == 0.0:
        return
    mean, factor = 0.5 * (s[at.TENSION + i - 1] + s[at.TENSION + i]), lump_share(loss, 1)
    s[at.LIMIT + i] += factor * abs(mean)
    s[at.LIMIT_BY_T + i] += math.copysign(factor, mean)


@kernel
def set_stribeck(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Multiply the limits of the lumps' friction by the Stribeck factor."""
    for i in range(1, laws.n + 1):
        factor, slope = stribeck(s[at.RATE + i] + step.frame.rate, laws.lump.stribeck)
        s[at.LIMIT_BY_V + i] = s[at.LIMIT + i] * slope
        s[at.LIMIT + i] *= factor
        s[at.LIMIT_BY_T + i] *= factor


@kernel
def balance_lumps(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the rows of the lumps."""
    inertia = laws.lump.mass / step.gh
    for i in range(1, laws.n + 1):
        speed = s[at.RATE + i] + step.frame.rate
        friction_force, by_speed, by_limit, deflection = friction(
            s[at.DEFLECTION_HISTORY + i], speed, step.gh, s[at.LIMIT + i], laws.lump.bristle
        )
        half = 0.5 * by_limit * s[at.LIMIT_BY_T + i]
        before = (half - 1.0) * s[at.TENSION_SLOPE + i - 1]
        behind = (half + 1.0) * s[at.TENSION_SLOPE + i]
        s[at.LOWER + i] = before
        s[at.UPPER + i] = -behind
        s[at.DIAGONAL + i] = inertia + by_speed + by_limit * s[at.LIMIT_BY_V + i] - before + behind
        s[at.RESIDUAL + i] = (
            s[at.TENSION + i - 1]
            - s[at.TENSION + i]
            - friction_force
            - inertia * (speed - s[at.SPEED_HISTORY + i])
        )
        s[at.FRICTION + i] = friction_force
        s[at.DEFLECTION_NEW + i] = deflection


@kernel
def balance_drive(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the row of the drive's end: at a given position, or with a given force."""
    s[at.LOWER] = 0.0
    if laws.drive.given == DISPLACEMENT:
        s[at.UPPER], s[at.DIAGONAL], s[at.RESIDUAL] = 0.0, 1.0, -s[at.RATE]
        return
    friction_force, by_speed, deflection = end_friction(
        s[at.DEFLECTION_HISTORY], s[at.RATE], step, laws.drive.friction_N, laws
    )
    stiffness = proximal_spring_force(1.0, laws.drive.spring_N_per_mm)
    position = s[at.POSITION_HISTORY] + step.gh * s[at.RATE]
    s[at.UPPER] = -s[at.TENSION_SLOPE]
    damping = laws.drive.damping_N_s_per_mm
    inertia = drive_inertia_force(1.0, laws.drive.mass_kg) / step.gh
    s[at.DIAGONAL] = s[at.TENSION_SLOPE] + stiffness * step.gh + by_speed + damping + inertia
    beside = friction_force + drive_damper_force(s[at.RATE], damping)
    beside += inertia * (s[at.RATE] - s[at.SPEED_HISTORY]) + laws.drive.spring_N
    s[at.RESIDUAL] = (
        step.drive.value - s[at.TENSION] - proximal_spring_force(position, stiffness) - beside
    )
    s[at.FRICTION], s[at.DEFLECTION_NEW] = friction_force, deflection


@kernel
def balance_load(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the row of the load's end: spring, mass and guide; a given force, or position."""
    last = laws.n + 1
    s[at.UPPER + last] = 0.0
    if laws.load.given == DISPLACEMENT:
        position = s[at.POSITION_HISTORY + last] + step.gh * s[at.RATE + last]
        s[at.LOWER + last], s[at.DIAGONAL + last] = 0.0, 1.0
        s[at.RESIDUAL + last] = (step.load.value - step.frame.value - position) / step.gh
        return
    behind = s[at.TENSION_SLOPE + laws.n]
    speed = s[at.RATE + last] + step.frame.rate
    friction_force, by_speed, deflection = end_friction(
        s[at.DEFLECTION_HISTORY + last], speed, step, moving_friction(laws.load), laws
    )
    pull, by_position, inertia = step.load.value, 0.0, 0.0
    if laws.load.given == SPRING:
        position = s[at.POSITION_HISTORY + last] + step.gh * s[at.RATE + last] + step.frame.value
        force, by_position = spring_law(position, laws.load)
        pull = laws.preload_N - step.lost_N + force
        inertia = inertia_force(1.0, laws.load.mass_kg) / step.gh
        damping = laws.load.damping_N_s_per_mm
        pull += inertia * (speed - s[at.SPEED_HISTORY + last]) + load_damper_force(speed, damping)
        by_speed += damping
        force, by_travel = beside_spring(s, speed, step, laws)
        pull += force
        by_speed += by_travel * step.gh
    s[at.LOWER + last] = -behind
    s[at.DIAGONAL + last] = behind + by_position * step.gh + inertia + by_speed
    s[at.RESIDUAL + last] = s[at.TENSION + laws.n] - pull - friction_force
    s[at.FRICTION + last], s[at.DEFLECTION_NEW + last] = friction_force, deflection


@kernel
def beside_spring(s: Floats, speed: float, step: Step, laws: LugreLaws) -> tuple[float, float]:
    """Return the forces of hysteresis and relaxation of the load [N], and their slope [N/mm]."""
    load, moved = laws.load, step.gh * speed
    element_N, slope = element_force(s[at.LOAD_STATE_HISTORY], moved, load.hysteresis)
    stretched = 1.0 / (1.0 + step.gh / load.relaxation.time_s)
    stretch = (s[at.LOAD_STATE_HISTORY + 1] + moved) * stretched
    s[at.LOAD_STATE_NEW], s[at.LOAD_STATE_NEW + 1] = element_N, stretch
    stiffness, share = load.stiffness_N_per_mm, load.relaxation.share
    relaxing_N = relaxing_force(stretch, stiffness, share)
    return element_N + relaxing_N, slope + relaxing_force(stretched, stiffness, share)


@kernel
def end_friction(
    before: float, speed: float, step: Step, limit: float, laws: LugreLaws
) -> tuple[float, float, float]:
    """Return friction of an end, its derivative by speed, and its bristle's deflection."""
    if limit == 0.0:
        return 0.0, 0.0, 0.0
    force, by_speed, _, deflection = friction(before, speed, step.gh, limit, laws.end_bristle)
    return force, by_speed, deflection
