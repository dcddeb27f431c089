"""Residual forces of the lumps and their derivatives by the speeds: Newton's equations.

Each lump: m dv/dt = T before − T behind − f (Yang 2025, Eqs. 10 to 14), f by `bristles` with the
limit g = μ N, N by the mean of both tensions (Eq. 17; 2 tanh(μθ/2n) for its sine, so that the
tension ratio over a sliding lump is e^(−μθ/n), Eq. 7). The ends have no mass: their forces balance.
The residual depends on the speeds of a node and its two neighbours: the Jacobian is tridiagonal.
"""

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
from tsas_cli.physics.lugre.state import (
    DEFLECTION_HISTORY,
    DEFLECTION_NEW,
    DIAGONAL,
    FRICTION,
    LIMIT,
    LIMIT_BY_T,
    LIMIT_BY_V,
    LOAD_STATE_HISTORY,
    LOAD_STATE_NEW,
    LOWER,
    POSITION_HISTORY,
    RATE,
    RESIDUAL,
    SPEED_HISTORY,
    TENSION,
    TENSION_HISTORY,
    TENSION_SLOPE,
    UPPER,
    LugreLaws,
    Step,
)
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
        a += abs(s[RESIDUAL + i])
        b += abs(s[RESIDUAL + i + 1])
        c += abs(s[RESIDUAL + i + 2])
        d += abs(s[RESIDUAL + i + 3])
    for i in range(whole, count):
        a += abs(s[RESIDUAL + i])
    return a + b + c + d


@kernel
def set_tensions(s: Floats, laws: LugreLaws) -> None:
    """Set the segments' tensions, Yang 2025, Eq. (11)."""
    for j in range(laws.n + 1):
        s[TENSION + j] = s[TENSION_HISTORY + j] + s[TENSION_SLOPE + j] * (
            s[RATE + j] - s[RATE + j + 1]
        )


@kernel
def set_limits(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set the limits of the lumps' friction and their derivatives, Yang 2025, Eqs. (16) to (19)."""
    for i in range(1, laws.n + 1):
        mean = 0.5 * (s[TENSION + i - 1] + s[TENSION + i])
        deflected = s[DEFLECTION_HISTORY + i] + step.gh * (s[RATE + i] + step.frame.rate)
        factor = step.pulled if deflected >= 0.0 else step.released
        factor = factor if mean >= 0.0 else -factor
        s[LIMIT + i] = factor * mean + LEAST_LIMIT_N
        s[LIMIT_BY_T + i] = factor
        s[LIMIT_BY_V + i] = 0.0
    if laws.lump.friction_exponent != 0.0:
        for i in range(1, laws.n + 1):
            mean = 0.5 * (s[TENSION + i - 1] + s[TENSION + i])
            factor = load_factor(mean / laws.preload_N, laws.lump.friction_exponent)
            s[LIMIT + i] *= factor
            s[LIMIT_BY_T + i] *= factor * (1.0 + laws.lump.friction_exponent)
    if laws.lump.friction_slope != 0.0:
        for i in range(1, laws.n + 1):
            factor = place_factor((i - 0.5) / laws.n, laws.lump.friction_slope)
            s[LIMIT + i] *= factor
            s[LIMIT_BY_T + i] *= factor
    if laws.lump.stribeck.excess != 0.0:
        set_stribeck(s, step, laws)


@kernel
def set_stribeck(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Multiply the limits of the lumps' friction by the Stribeck factor."""
    for i in range(1, laws.n + 1):
        factor, slope = stribeck(s[RATE + i] + step.frame.rate, laws.lump.stribeck)
        s[LIMIT_BY_V + i] = s[LIMIT + i] * slope
        s[LIMIT + i] *= factor
        s[LIMIT_BY_T + i] *= factor


@kernel
def balance_lumps(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the rows of the lumps."""
    inertia = laws.lump.mass / step.gh
    for i in range(1, laws.n + 1):
        speed = s[RATE + i] + step.frame.rate
        friction_force, by_speed, by_limit, deflection = friction(
            s[DEFLECTION_HISTORY + i], speed, step.gh, s[LIMIT + i], laws.lump.bristle
        )
        half = 0.5 * by_limit * s[LIMIT_BY_T + i]
        before = (half - 1.0) * s[TENSION_SLOPE + i - 1]
        behind = (half + 1.0) * s[TENSION_SLOPE + i]
        s[LOWER + i] = before
        s[UPPER + i] = -behind
        s[DIAGONAL + i] = inertia + by_speed + by_limit * s[LIMIT_BY_V + i] - before + behind
        s[RESIDUAL + i] = (
            s[TENSION + i - 1]
            - s[TENSION + i]
            - friction_force
            - inertia * (speed - s[SPEED_HISTORY + i])
        )
        s[FRICTION + i] = friction_force
        s[DEFLECTION_NEW + i] = deflection


@kernel
def balance_drive(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the row of the drive's end: at a given position, or with a given force."""
    s[LOWER] = 0.0
    if laws.drive.given == DISPLACEMENT:
        s[UPPER], s[DIAGONAL], s[RESIDUAL] = 0.0, 1.0, -s[RATE]
        return
    friction_force, by_speed, deflection = end_friction(
        s[DEFLECTION_HISTORY], s[RATE], step, laws.drive.friction_N, laws
    )
    stiffness = proximal_spring_force(1.0, laws.drive.spring_N_per_mm)
    position = s[POSITION_HISTORY] + step.gh * s[RATE]
    s[UPPER] = -s[TENSION_SLOPE]
    damping = laws.drive.damping_N_s_per_mm
    inertia = drive_inertia_force(1.0, laws.drive.mass_kg) / step.gh
    s[DIAGONAL] = s[TENSION_SLOPE] + stiffness * step.gh + by_speed + damping + inertia
    beside = friction_force + drive_damper_force(s[RATE], damping)
    beside += inertia * (s[RATE] - s[SPEED_HISTORY])
    s[RESIDUAL] = (
        step.drive.value - s[TENSION] - proximal_spring_force(position, stiffness) - beside
    )
    s[FRICTION], s[DEFLECTION_NEW] = friction_force, deflection


@kernel
def balance_load(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Set up the row of the load's end: spring, mass and guide; a given force, or position."""
    last = laws.n + 1
    s[UPPER + last] = 0.0
    if laws.load.given == DISPLACEMENT:
        position = s[POSITION_HISTORY + last] + step.gh * s[RATE + last]
        s[LOWER + last], s[DIAGONAL + last] = 0.0, 1.0
        s[RESIDUAL + last] = (step.load.value - step.frame.value - position) / step.gh
        return
    behind = s[TENSION_SLOPE + laws.n]
    speed = s[RATE + last] + step.frame.rate
    friction_force, by_speed, deflection = end_friction(
        s[DEFLECTION_HISTORY + last], speed, step, moving_friction(laws.load), laws
    )
    pull, by_position, inertia = step.load.value, 0.0, 0.0
    if laws.load.given == SPRING:
        position = s[POSITION_HISTORY + last] + step.gh * s[RATE + last] + step.frame.value
        force, by_position = spring_law(position, laws.load)
        pull = laws.preload_N - step.lost_N + force
        inertia = inertia_force(1.0, laws.load.mass_kg) / step.gh
        damping = laws.load.damping_N_s_per_mm
        pull += inertia * (speed - s[SPEED_HISTORY + last]) + load_damper_force(speed, damping)
        by_speed += damping
        force, by_travel = beside_spring(s, speed, step, laws)
        pull += force
        by_speed += by_travel * step.gh
    s[LOWER + last] = -behind
    s[DIAGONAL + last] = behind + by_position * step.gh + inertia + by_speed
    s[RESIDUAL + last] = s[TENSION + laws.n] - pull - friction_force
    s[FRICTION + last], s[DEFLECTION_NEW + last] = friction_force, deflection


@kernel
def beside_spring(s: Floats, speed: float, step: Step, laws: LugreLaws) -> tuple[float, float]:
    """Return the forces of hysteresis and relaxation of the load [N], and their slope [N/mm]."""
    load, moved = laws.load, step.gh * speed
    element_N, slope = element_force(s[LOAD_STATE_HISTORY], moved, load.hysteresis)
    stretched = 1.0 / (1.0 + step.gh / load.relaxation.time_s)
    stretch = (s[LOAD_STATE_HISTORY + 1] + moved) * stretched
    s[LOAD_STATE_NEW], s[LOAD_STATE_NEW + 1] = element_N, stretch
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
