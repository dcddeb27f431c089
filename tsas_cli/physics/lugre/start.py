"""The dynamic chain before its first step: the laws of a rig, its segments, nodes at rest."""

import math

from tsas_cli.effects.presliding import bristle_compliance, fixed_travel
from tsas_cli.effects.sheath_drag import drag_over
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import SPRING, Boundary, DriveEnd, drive_end, load_end
from tsas_cli.physics.bristles import Bristle, bristle_damping, tendon_mass
from tsas_cli.physics.course import DRIVE
from tsas_cli.physics.lugre import state as at
from tsas_cli.physics.lugre.balance import balance, set_limits
from tsas_cli.physics.lugre.ends import StepEnds, ends_after
from tsas_cli.physics.lugre.input import step_at, value_at
from tsas_cli.physics.lugre.state import ROWS, LugreLaws, Lump, Step
from tsas_cli.physics.lugre.step import bdf2
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

NO_TIME_S = 1e-13  # step of the balance at rest


@kernel
def bristles_of(rig: Rig) -> Bristle:
    """Return the bristles of the whole sheath."""
    presliding, wrap = rig.effects.presliding, rig.friction_coefficient * rig.total_bend_rad
    fixed, compliance = fixed_travel(presliding), bristle_compliance(presliding, wrap)
    stiffness = 1.0 / (1.0 / rig.bristles.stiffness_N_per_mm + compliance)
    limit = rig.preload_N * wrap
    limit += rig.effects.sheath_drag.force_N
    damping = bristle_damping(rig.bristles, rig.sheath_length_mm, limit, fixed + compliance * limit)
    viscous = rig.effects.viscous_friction.coefficient_N_s_per_mm
    return Bristle(stiffness, damping, viscous, fixed)


@kernel
def lugre_laws(rig: Rig, n: int, boundary: Boundary) -> LugreLaws:
    """Return the constants of the rig for every step, with the given quantities at the ends."""
    effects, whole = rig.effects, bristles_of(rig)
    lump = Lump(
        tendon_mass(rig.bristles, rig.sheath_length_mm) / n,
        Bristle(whole.stiffness / n, whole.damping / n, whole.viscous / n, whole.travel),
        effects.load_dependent_friction.exponent,
        effects.uneven_friction.slope,
        drag_over(1.0 / n, effects.sheath_drag.force_N),
        effects.stribeck_friction,
    )
    end_bristle = Bristle(whole.stiffness, whole.damping, 0.0, 0.0)
    drive, load = drive_end(rig, boundary.drive), load_end(rig, boundary.load)
    return LugreLaws(n, rig.preload_N, lump, effects.pulley_friction, end_bristle, drive, load)


@kernel
def with_drive(laws: LugreLaws, drive: DriveEnd) -> LugreLaws:
    """Return the laws with another end at the drive."""
    return LugreLaws(
        laws.n, laws.preload_N, laws.lump, laws.pulleys, laws.end_bristle, drive, laws.load
    )


@kernel
def segments(rig: Rig, n: int) -> tuple[Floats, Floats]:
    """Return stiffness and damping of the n + 1 segments [N/mm, N s/mm]."""
    stiffness = 1.0 / segment_compliances(rig, n)
    relaxation_s = rig.bristles.tendon_damping_N_s_per_mm * rig.sheath_length_mm
    return stiffness, relaxation_s / rig.tendon_stiffness_N * stiffness


@kernel
def clear_state(s: Floats, rig: Rig, n: int) -> None:
    """Set the tendon's segments, and all other rows to zero."""
    for row in range(ROWS):
        for i in range(n + 2):
            s[PITCH * row + i] = 0.0
    set_segments(s, rig, n)


@kernel
def set_segments(s: Floats, rig: Rig, n: int) -> None:
    """Set stiffness and damping of the tendon's segments."""
    stiffness, damping = segments(rig, n)
    for j in range(n + 1):
        s[at.STIFFNESS + j], s[at.DAMPING + j] = stiffness[j], damping[j]


@kernel
def start_at_rest(
    s: Floats, start: Floats, course: Floats, k: int, t: float, laws: LugreLaws
) -> StepEnds:
    """Set the nodes at rest at a time from sample k to the next; see `rest_at`."""
    drive = value_at(course, DRIVE, k, t).value
    formula = bdf2(NO_TIME_S, math.inf, math.inf)
    step = step_at(course, k, t, formula, (drive, drive), laws)
    return rest_at(s, start, step, laws)


@kernel
def rest_at(s: Floats, start: Floats, step: Step, laws: LugreLaws) -> StepEnds:
    """Set the nodes at rest, with bristles that balance the tensions; return the ends.

    `start` has positions and tensions, shape (2, n + 2) [mm, N], and `step`, of zero length, the
    given quantities.
    """
    last = laws.n + 1
    for i in range(laws.n + 2):
        s[at.POSITION + i] = s[at.POSITION_HISTORY + i] = start[0, i] - step.frame.value
        s[at.TENSION_HISTORY + i], s[at.TENSION_SLOPE + i] = start[1, i], 0.0
        s[at.SPEED + i] = s[at.SPEED_HISTORY + i] = s[at.RATE + i] = s[
            at.DEFLECTION_HISTORY + i
        ] = 0.0
    s[at.LOAD_STATE_HISTORY] = s[at.LOAD_STATE_HISTORY + 1] = s[at.LOAD_STATE + 1] = 0.0
    balance(s, step, laws)
    element_N = laws.load.hysteresis.force_N if laws.load.given == SPRING else 0.0
    s[at.LOAD_STATE] = min(max(s[at.RESIDUAL + last], -element_N), element_N)  # before the guide
    for i in range(1, laws.n + 1):
        s[at.DEFLECTION_HISTORY + i] = s[at.RESIDUAL + i]  # its sign decides between the limits
    set_limits(s, step, laws)
    for i in range(1, laws.n + 1):
        share = min(max(s[at.RESIDUAL + i] / s[at.LIMIT + i], -1.0), 1.0)
        s[at.DEFLECTION + i] = (
            s[at.RESIDUAL + i] / laws.lump.bristle.stiffness + share * laws.lump.bristle.travel
        )
    s[at.DEFLECTION] = s[at.RESIDUAL] / laws.end_bristle.stiffness
    s[at.DEFLECTION + last] = (
        s[at.RESIDUAL + last] - s[at.LOAD_STATE]
    ) / laws.end_bristle.stiffness
    return ends_after(s, step, laws)
