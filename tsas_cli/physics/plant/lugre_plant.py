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
from tsas_cli.physics.boundary import (
    DISPLACEMENT,
    FORCE,
    SPRING,
    Boundary,
    DriveEnd,
    share_before_sensor,
)
from tsas_cli.physics.ends import losses_without_speed
from tsas_cli.physics.lugre.balance import balance_drive
from tsas_cli.physics.lugre.ends import EndState, StepEnds, ends_after
from tsas_cli.physics.lugre.input import lump_share
from tsas_cli.physics.lugre.slack import shortening, slack_state, unloaded_load
from tsas_cli.physics.lugre.start import (
    NO_TIME_S,
    clear_state,
    lugre_laws,
    rest_at,
    set_segments,
    with_drive,
)
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
    Given,
    LugreLaws,
    Step,
)
from tsas_cli.physics.lugre.step import MOST_ITERATIONS, accept_step, bdf2
from tsas_cli.physics.lugre.step_size import fit_to_reversal, step_factor, tolerances_of, try_step
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.plant.turntable import (
    DriveStep,
    Turntable,
    advance_turntable,
    spring_of,
    turntable_at,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as slip

DRIVEN = Boundary(FORCE, SPRING)
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
    """Return room for lumps, for `lumps_at_rest` to fill."""
    return np.empty(ROWS * PITCH)


@kernel
def lumps_at_rest(s: Floats, chain: Floats, f_in: float, rig: Rig, n: int) -> LumpedTendon:
    """Put lumps at rest where a slip chain is, with a force at the drive [N]."""
    laws, start = lugre_laws(rig, n, DRIVEN), np.empty((2, n + 2))
    clear_state(s, rig, n)
    for j in range(n + 2):
        start[0, j], start[1, j] = chain[slip.POSITION + j], chain[slip.TENSION + j]
    step = step_of_rest(f_in, 0.0, rig, n)
    ends = rest_at(s, start, step, laws)
    if s[POSITION] < taut_position(s, step, laws):
        return slack_tendon(step, laws)
    return restarted(ends, True)


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
    table: Turntable, s: Floats, tendon: LumpedTendon, rig: Rig, laws: LugreLaws, step: DriveStep
) -> tuple[Turntable, LumpedTendon, bool]:
    """Move turntable, tendon and load by a step; `laws` are those of a drive by force.

    Returns the turntable, the tendon, and whether its steps were solved and within their error.
    Where Newton's method fails the tendon is left behind, for the next step to catch up with.
    """
    p, h = s[POSITION], step.h
    spring = spring_of(table, p, rig, step)
    given = step_of_rest(spring.force, step.time_s, rig, laws.n)
    if tendon.touched != spring.touches and not tendon.slack:
        tendon = restarted(tendon.ends, spring.touches)
    solved, arrived, x, f_in = True, True, spring.x, table.f_in
    drive = laws.drive
    if spring.touches:
        beside = drive.spring_N_per_mm + spring.stiffness
        held = with_drive(laws, DriveEnd(FORCE, drive.friction_N, beside))
        if tendon.slack:
            tendon, solved = pull_slack(s, given, held, h)
    else:
        held = with_drive(laws, DriveEnd(DISPLACEMENT, drive.friction_N, drive.spring_N_per_mm))
    tension = tendon.ends.drive.tension
    if not tendon.slack:
        before = table.f_in + spring.stiffness * p
        tendon, arrived, solved = advance_lumps(s, tendon, before, given, held, h)
    if not spring.touches:
        f_in += tendon.ends.drive.tension - tension
    else:
        if tendon.ends.drive.tension < 0.0 and s[POSITION] <= taut_position(s, given, laws):
            s[POSITION] = (given.drive.value - s[FRICTION]) / held.drive.spring_N_per_mm
            tendon = slack_tendon(given, laws)
        if arrived:
            x, f_in = turntable_at(s[POSITION], spring)
    return advance_turntable(table, x, f_in, (s[POSITION] - p) / h, h), tendon, solved


@kernel
def advance_lumps(
    s: Floats, tendon: LumpedTendon, before: float, step: Step, laws: LugreLaws, h: float
) -> tuple[LumpedTendon, bool, bool]:
    """Move the lumps by h, the force at the drive going straight from before to the step's.

    Returns the tendon, whether it has arrived, and whether every step was within its error, which
    does not count any more after many tries.
    """
    ends, length, h1, h2, touched, _ = tendon
    length, done, tolerance = min(length, h), 0.0, TOLERANCE
    for tries in range(MOST_TRIES):
        if tries == CAREFUL_TRIES:
            length, h1, h2, tolerance = h - done, math.inf, math.inf, ROUGH
        length, lands = fit_to_reversal(length, h - done)
        part = 1.0 if lands else (done + length) / h
        formula = bdf2(length, h1, h2)
        to = with_drive_force(step, before + part * (step.drive.value - before), formula.gh)
        most = tolerances_of(ends, laws, tolerance, LEAVES)
        off, _ = try_step(s, to, formula, laws, most)
        change = step_factor(off, most, formula)
        if off < most.error_N:
            ends = ends_after(s, to, laws)
            accept_step(s, to, laws)
            done, length, h1, h2 = done + length, length * change, length, h1
            if lands:
                tendon = LumpedTendon(ends, length, h1, h2, touched, False)
                return tendon, True, tolerance == TOLERANCE
        else:
            length *= change
    return restarted(ends, touched), False, False


@kernel
def pull_slack(s: Floats, step: Step, laws: LugreLaws, h: float) -> tuple[LumpedTendon, bool]:
    """Move the end of a slack tendon; where that would stretch it, put it at rest taut instead.

    Returns the tendon and whether the end's position was found.
    """
    place, deflection = s[POSITION], s[DEFLECTION]
    s[POSITION_HISTORY], s[DEFLECTION_HISTORY], s[RATE] = place, deflection, 0.0
    s[TENSION] = s[TENSION_SLOPE] = 0.0
    step, solved = with_drive_force(step, step.drive.value, h), False
    for _ in range(MOST_ITERATIONS):
        balance_drive(s, step, laws)
        solved = abs(s[RESIDUAL]) <= 1e-9 * laws.preload_N
        if solved:
            break
        s[RATE] += s[RESIDUAL] / s[DIAGONAL]
    s[POSITION], s[SPEED], s[DEFLECTION] = place + h * s[RATE], s[RATE], s[DEFLECTION_NEW]
    if s[POSITION] <= taut_position(s, step, laws):
        return slack_tendon(step, laws), solved
    start = slack_state(s, unloaded_load(step.lost_N, laws), laws)
    ends = rest_at(s, start, with_drive_force(step, 0.0, NO_TIME_S), laws)
    s[DEFLECTION] = deflection
    return restarted(ends, True), True


@kernel
def taut_position(s: Floats, step: Step, laws: LugreLaws) -> float:
    """Return where the drive's end of the tendon is when it is straight without tension [mm]."""
    return unloaded_load(step.lost_N, laws) - shortening(s, laws)


@kernel
def slack_tendon(step: Step, laws: LugreLaws) -> LumpedTendon:
    """Return a tendon that hangs slack."""
    drive = EndState(Given(0.0, 0.0), 0.0, 0.0, 0.0, 0.0)
    load = EndState(Given(0.0, 0.0), unloaded_load(step.lost_N, laws), 0.0, 0.0, 0.0)
    ends = StepEnds(drive, load, 0.0)
    return LumpedTendon(ends, math.inf, math.inf, math.inf, True, True)


@kernel
def step_of_rest(force: float, time_s: float, rig: Rig, n: int) -> Step:
    """Return a step of no time, at whose end a force pulls at the drive [N]."""
    losses = losses_without_speed(time_s, 0.0, rig)
    pulled, released = lump_share(losses.pulled, n), lump_share(losses.released, n)
    none = Given(0.0, 0.0)
    return Step(NO_TIME_S, Given(force, 0.0), none, none, pulled, released, losses.preload_N)


@kernel
def with_drive_force(step: Step, force: float, gh: float) -> Step:
    """Return a step with another force at the drive and another length."""
    drive = Given(force, 0.0)
    return Step(gh, drive, step.load, step.frame, step.pulled, step.released, step.lost_N)


@kernel
def tension_at_load(tendon: LumpedTendon, laws: LugreLaws) -> float:
    """Return the tension at the load's force sensor [N]."""
    return tendon.ends.load.tension - share_before_sensor(laws.load) * tendon.ends.guide
