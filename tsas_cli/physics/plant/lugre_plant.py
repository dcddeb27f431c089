"""The plant of a closed loop with the dynamic chain as its tendon; see `plant`.

The lumps take the same step of BDF2 as the turntable, which is a spring at the tendon's end then.
Where Newton's method fails or a tension is off by too much they take shorter ones, over which the
force moves straight. Where something jumps (the play catches the tendon's end or lets
go of it, a slack tendon is pulled, the rig changes) they begin with backward Euler.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.ends import friction_without_speed
from tsas_cli.physics.lugre.balance import balance_drive
from tsas_cli.physics.lugre.ends import StepEnds, ends_after, sensor_share
from tsas_cli.physics.lugre.input import lump_share
from tsas_cli.physics.lugre.slack import shortening, slack_state, unloaded_load
from tsas_cli.physics.lugre.start import NO_TIME_S, clear_state, lugre_laws, rest_at, set_segments
from tsas_cli.physics.lugre.state import (
    DEFLECTION,
    DEFLECTION_HISTORY,
    DEFLECTION_NEW,
    DIAGONAL,
    FRICTION,
    POSITION,
    POSITION_HISTORY,
    RATE,
    RESIDUAL,
    ROWS,
    SPEED,
    TENSION,
    TENSION_SLOPE,
    Floats,
    LugreLaws,
    Step,
)
from tsas_cli.physics.lugre.step import MOST_ITERATIONS, accept_step, bdf2
from tsas_cli.physics.lugre.step_size import fit_to_reversal, step_factor, tolerances_of, try_step
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.plant.turntable import (
    Actuator,
    Turntable,
    advance_turntable,
    spring_of,
    turntable_at,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as slip

TOLERANCE = 1e-4  # of a tension: what a step of the lumps may add to its error
LEAVES = 1e-7  # what Newton's method may leave: more shakes a turntable that is at rest
ROUGH = 1.0  # the same where that is not to be had
CAREFUL_TRIES, MOST_TRIES = 200, 300  # of steps of the lumps in one of the plant


class LumpedTendon(NamedTuple):
    """The tendon beside its lumps: both ends, and how steps go on."""

    ends: StepEnds
    h: float  # the step to take next, and the two before it, infinite where there was none [s]
    h1: float
    h2: float
    touched: bool  # by the drive, which is not within its play
    slack: bool


def empty_lumps() -> Floats:
    """Return room for lumps, for `lay_lumps` to lay them down."""
    return np.empty(ROWS * PITCH)


@kernel
def lumps_at_rest(s: Floats, chain: Floats, f_in: float, rig: Rig, n: int) -> LumpedTendon:
    """Lay lumps down at rest where a slip chain is, with a force at the drive [N]."""
    law, start = lugre_laws(rig, n), np.empty((2, n + 2))
    clear_state(s, rig, n)
    for j in range(n + 2):
        start[0, j], start[1, j] = chain[slip.POSITION + j], chain[slip.TENSION + j]
    step = step_of_rest(f_in, 0.0, rig, n)
    ends = rest_at(s, start, step, Boundary(FORCE, SPRING), law)
    return (
        slack_tendon(step, law)
        if s[POSITION] < taut_position(s, step, law)
        else restarted(ends, True)
    )


@kernel
def with_rig(s: Floats, tendon: LumpedTendon, rig: Rig, n: int) -> LumpedTendon:
    """Go on with another rig."""
    set_segments(s, rig, n)
    return LumpedTendon(tendon.ends, math.inf, math.inf, math.inf, tendon.touched, tendon.slack)


@kernel
def restarted(ends: StepEnds, touched: bool) -> LumpedTendon:
    """Return a tendon from whose ends the next step is a first one."""
    return LumpedTendon(ends, math.inf, math.inf, math.inf, touched, False)


@kernel
def step_lumped_plant(
    table: Turntable,
    s: Floats,
    tendon: LumpedTendon,
    time_s: float,
    rig: Rig,
    law: LugreLaws,
    actuator: Actuator,
    h: float,
) -> tuple[Turntable, LumpedTendon, bool]:
    """Move turntable, tendon and load by h to a time, the motor being there already.

    Returns the turntable, the tendon, and whether its steps were solved and within their error.
    Where Newton's method fails the tendon is left behind, for the next step to catch up with.
    """
    p = s[POSITION]
    reach = spring_of(table, p, rig, actuator, h)
    step = step_of_rest(reach.drive, time_s, rig, law.n)
    if tendon.touched != reach.touches and not tendon.slack:
        tendon = restarted(tendon.ends, reach.touches)
    settled, arrived, x, f_in = True, True, reach.x, table.f_in
    boundary, held = Boundary(DISPLACEMENT, SPRING), law
    if reach.touches:
        boundary, held = Boundary(FORCE, SPRING), with_drive_spring(law, reach.share)
        if tendon.slack:
            tendon, settled = pull_slack(s, step, held, h)
    tension = tendon.ends.f_in
    if not tendon.slack:
        before = table.f_in + reach.share * p
        tendon, arrived, settled = advance_lumps(s, tendon, before, step, boundary, held, h)
    if not reach.touches:
        f_in += tendon.ends.f_in - tension
    else:
        if tendon.ends.f_in < 0.0 and s[POSITION] <= taut_position(s, step, law):
            s[POSITION] = (step.drive - s[FRICTION]) / held.proximal_spring_N_per_mm
            tendon = slack_tendon(step, law)
        if arrived:
            x, f_in = turntable_at(s[POSITION], reach)
    return advance_turntable(table, x, f_in, (s[POSITION] - p) / h, h), tendon, settled


@kernel
def advance_lumps(
    s: Floats,
    tendon: LumpedTendon,
    before: float,
    step: Step,
    boundary: Boundary,
    law: LugreLaws,
    h: float,
) -> tuple[LumpedTendon, bool, bool]:
    """Move the lumps by h, the force at the drive going straight from before to the step's.

    Returns the tendon, whether it has arrived, and whether every step was within its error, which
    does not count any more after many tries.
    """
    ends, length, h1, h2, _, _ = tendon
    length, done, tolerance = min(length, h), 0.0, TOLERANCE
    for tries in range(MOST_TRIES):
        if tries == CAREFUL_TRIES:
            length, h1, h2, tolerance = h - done, math.inf, math.inf, ROUGH
        length, lands = fit_to_reversal(length, h - done)
        part = 1.0 if lands else (done + length) / h
        formula = bdf2(length, h1, h2)
        to = with_drive_force(step, before + part * (step.drive - before), formula.gh)
        most = tolerances_of(ends, law, tolerance, LEAVES)
        off, _ = try_step(s, to, formula, boundary, law, most)
        change = step_factor(off, most, formula)
        if off < most.error_N:
            ends = ends_after(s, to, law)
            accept_step(s, to, law)
            done, length, h1, h2 = done + length, length * change, length, h1
            if lands:
                return (
                    LumpedTendon(ends, length, h1, h2, tendon.touched, False),
                    True,
                    tolerance == TOLERANCE,
                )
        else:
            length *= change
    return restarted(ends, tendon.touched), False, False


@kernel
def pull_slack(s: Floats, step: Step, law: LugreLaws, h: float) -> tuple[LumpedTendon, bool]:
    """Move the end of a slack tendon; where that would stretch it, lay it down taut instead.

    Returns the tendon and whether the end's place was found.
    """
    place, deflection = s[POSITION], s[DEFLECTION]
    s[POSITION_HISTORY], s[DEFLECTION_HISTORY], s[RATE] = place, deflection, 0.0
    s[TENSION] = s[TENSION_SLOPE] = 0.0
    step, settled = with_drive_force(step, step.drive, h), False
    for _ in range(MOST_ITERATIONS):
        balance_drive(s, step, Boundary(FORCE, SPRING), law)
        settled = abs(s[RESIDUAL]) <= 1e-9 * law.preload_N
        if settled:
            break
        s[RATE] += s[RESIDUAL] / s[DIAGONAL]
    s[POSITION], s[SPEED], s[DEFLECTION] = place + h * s[RATE], s[RATE], s[DEFLECTION_NEW]
    if s[POSITION] <= taut_position(s, step, law):
        return slack_tendon(step, law), settled
    start = slack_state(s, unloaded_load(step.lost_N, law), law)
    ends = rest_at(s, start, with_drive_force(step, 0.0, NO_TIME_S), Boundary(FORCE, SPRING), law)
    s[DEFLECTION] = deflection
    return restarted(ends, True), True


@kernel
def taut_position(s: Floats, step: Step, law: LugreLaws) -> float:
    """Return where the drive's end of the tendon is when it is straight without tension [mm]."""
    return unloaded_load(step.lost_N, law) - shortening(s, law)


@kernel
def slack_tendon(step: Step, law: LugreLaws) -> LumpedTendon:
    """Return a tendon that hangs slack."""
    load = unloaded_load(step.lost_N, law)
    ends = StepEnds(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, load, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return LumpedTendon(ends, math.inf, math.inf, math.inf, True, True)


@kernel
def step_of_rest(drive: float, time_s: float, rig: Rig, n: int) -> Step:
    """Return a step of no time, at whose end a force pulls at the drive [N]."""
    pulled, released, lost_N = friction_without_speed(time_s, 0.0, rig)
    limits = lump_share(pulled, n), lump_share(released, n)
    return Step(NO_TIME_S, drive, 0.0, 0.0, 0.0, 0.0, 0.0, limits[0], limits[1], lost_N)


@kernel
def with_drive_force(step: Step, drive: float, gh: float) -> Step:
    """Return a step with another force at the drive and another length."""
    return Step(gh, drive, 0.0, 0.0, 0.0, 0.0, 0.0, step.pulled, step.released, step.lost_N)


@kernel
def tension_at_load(tendon: LumpedTendon, law: LugreLaws) -> float:
    """Return what a force sensor at the load feels [N]."""
    share = sensor_share(Boundary(FORCE, SPRING), law)
    return tendon.ends.f_out - share * tendon.ends.guide


@kernel
def with_drive_spring(law: LugreLaws, stiffness: float) -> LugreLaws:
    """Return the law with a spring more between the tendon's end and the ground [N/mm]."""
    return LugreLaws(
        law.n,
        law.preload_N,
        law.lump_mass,
        law.bristle,
        law.end_bristle,
        law.friction_exponent,
        law.stribeck,
        law.load_stiffness_N_per_mm,
        law.load_spring,
        law.load_friction,
        law.load_mass_kg,
        law.drive_friction_N,
        law.proximal_spring_N_per_mm + stiffness,
    )
