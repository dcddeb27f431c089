"""The plant of a closed loop with the dynamic chain as its tendon; see `turntable`.

The lumps use the same BDF2 step as the turntable, which acts as a spring at the tendon's end. Where
Newton's method fails or the error of a tension is too large they use shorter steps, over which the
force changes linearly. After a discontinuity (contact in the play begins or ends, a slack tendon
tightens, the rig changes) they restart with backward Euler.
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
    share_before_sensor,
    with_spring,
)
from tsas_cli.physics.course import with_friction
from tsas_cli.physics.ends import losses_at
from tsas_cli.physics.lugre import state as at
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
from tsas_cli.physics.lugre.state import ROWS, Given, LugreLaws, Step
from tsas_cli.physics.lugre.step import (
    MOST_ITERATIONS,
    accept_step,
    bdf2,
    fit_to_reversal,
    step_factor,
    tolerances_of,
    try_step,
)
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
from tsas_cli.support.arrays import Floats

DRIVEN = Boundary(FORCE, SPRING)
TOLERANCE = 1e-4  # error that a step of the lumps may add, over a tension
RESIDUAL_SHARE = 1e-7  # of Newton's method, over a tension: more excites a turntable at rest
LOOSE_TOLERANCE = 1.0  # in place of TOLERANCE, after CAREFUL_TRIES
CAREFUL_TRIES, MOST_TRIES = 200, 300  # of steps of the lumps in one of the plant


class LumpedTendon(NamedTuple):
    """The tendon without its lumps: both ends, and the state of step control."""

    ends: StepEnds
    h: float  # the next step, and the two before it, infinite where there are none [s]
    h1: float
    h2: float
    touched: bool  # in contact with the drive, which is not within its play
    slack: bool


def empty_lumps() -> Floats:
    """Return unfilled arrays for lumps, for `lumps_at_rest` to fill."""
    return np.empty(ROWS * PITCH)


@kernel
def lumps_at_rest(
    s: Floats, chain: Floats, f_in: float, rig: Rig, n: int, friction: float
) -> LumpedTendon:
    """Set lumps at rest in the state of a slip chain, with a force at the drive [N].

    `friction` is a factor of the friction coefficient.
    """
    laws, start = lugre_laws(rig, n, DRIVEN), np.empty((2, n + 2))
    clear_state(s, rig, n)
    for j in range(n + 2):
        start[0, j], start[1, j] = chain[slip.POSITION + j], chain[slip.TENSION + j]
    step = step_of_rest(f_in, 0.0, start[0, 0], rig, n, friction)
    ends = rest_at(s, start, step, laws)
    if s[at.POSITION] < taut_position(s, step, laws):
        return slack_tendon(step, laws)
    return restarted(ends, True)


@kernel
def with_rig(s: Floats, tendon: LumpedTendon, rig: Rig, n: int) -> LumpedTendon:
    """Set another rig; the next step is a first one."""
    set_segments(s, rig, n)
    return LumpedTendon(tendon.ends, math.inf, math.inf, math.inf, tendon.touched, tendon.slack)


@kernel
def restarted(ends: StepEnds, touched: bool) -> LumpedTendon:
    """Return a tendon whose next step is a first one."""
    return LumpedTendon(ends, math.inf, math.inf, math.inf, touched, False)


@kernel
def step_lumped_plant(
    table: Turntable, s: Floats, tendon: LumpedTendon, rig: Rig, laws: LugreLaws, step: DriveStep
) -> tuple[Turntable, LumpedTendon, bool]:
    """Advance turntable, tendon and load by a step; `laws` are those of a drive by force.

    Returns the turntable, the tendon, and whether its steps converged within their error. Where
    Newton's method fails the tendon lags until the next step.
    """
    p, h = s[at.POSITION], step.h
    spring = spring_of(table, p, rig, step)
    given = step_of_rest(spring.force, step.time_s, p, rig, laws.n, step.friction)
    if tendon.touched != spring.touches and not tendon.slack:
        tendon = restarted(tendon.ends, spring.touches)
    solved, arrived, x, f_in = True, True, spring.x, table.f_in
    drive = laws.drive
    if spring.touches:
        stiffness = drive.spring_N_per_mm + spring.stiffness + step.beside.slope
        driven = with_drive(laws, with_spring(drive, FORCE, stiffness, step.beside.ahead))
        if tendon.slack:
            tendon, solved = pull_slack(s, given, driven, h)
    else:
        driven = with_drive(laws, with_spring(drive, DISPLACEMENT, drive.spring_N_per_mm))
    tension = tendon.ends.drive.tension
    if not tendon.slack:
        before = table.f_in + spring.stiffness * p
        tendon, arrived, solved = advance_lumps(s, tendon, before, given, driven, h)
    if not spring.touches:
        f_in += tendon.ends.drive.tension - tension
    else:
        if tendon.ends.drive.tension < 0.0 and s[at.POSITION] <= taut_position(s, given, laws):
            force = given.drive.value - s[at.FRICTION] - driven.drive.spring_N
            s[at.POSITION] = force / driven.drive.spring_N_per_mm
            tendon = slack_tendon(given, laws)
        if arrived:
            x, f_in = turntable_at(s[at.POSITION], spring)
    return advance_turntable(table, x, f_in, (s[at.POSITION] - p) / h, h), tendon, solved


@kernel
def advance_lumps(
    s: Floats, tendon: LumpedTendon, before: float, step: Step, laws: LugreLaws, h: float
) -> tuple[LumpedTendon, bool, bool]:
    """Advance the lumps by h, with a force at the drive linear from `before` to the step's.

    Returns the tendon, whether it has reached the end of h, and whether every step was within
    `TOLERANCE`, which is loosened after many tries.
    """
    ends, length, h1, h2, touched, _ = tendon
    length, done, tolerance = min(length, h), 0.0, TOLERANCE
    for tries in range(MOST_TRIES):
        if tries == CAREFUL_TRIES:
            length, h1, h2, tolerance = h - done, math.inf, math.inf, LOOSE_TOLERANCE
        length, lands = fit_to_reversal(length, h - done)
        part = 1.0 if lands else (done + length) / h
        formula = bdf2(length, h1, h2)
        to = with_drive_force(step, before + part * (step.drive.value - before), formula.gh)
        most = tolerances_of(ends, laws, tolerance, RESIDUAL_SHARE)
        error_N, _ = try_step(s, to, formula, laws, most)
        change = step_factor(error_N, most, formula)
        if error_N < most.error_N:
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
    """Move the end of a slack tendon; where it tightens, set it at rest, taut without tension.

    Returns the tendon and whether the end's position converged.
    """
    position, deflection = s[at.POSITION], s[at.DEFLECTION]
    s[at.POSITION_HISTORY], s[at.DEFLECTION_HISTORY], s[at.RATE] = position, deflection, 0.0
    s[at.SPEED_HISTORY] = s[at.SPEED]
    s[at.TENSION] = s[at.TENSION_SLOPE] = 0.0
    step, solved = with_drive_force(step, step.drive.value, h), False
    for _ in range(MOST_ITERATIONS):
        balance_drive(s, step, laws)
        solved = abs(s[at.RESIDUAL]) <= 1e-9 * laws.preload_N
        if solved:
            break
        s[at.RATE] += s[at.RESIDUAL] / s[at.DIAGONAL]
    s[at.POSITION], s[at.SPEED], s[at.DEFLECTION] = (
        position + h * s[at.RATE],
        s[at.RATE],
        s[at.DEFLECTION_NEW],
    )
    if s[at.POSITION] <= taut_position(s, step, laws):
        return slack_tendon(step, laws), solved
    start = slack_state(s, unloaded_load(step.lost_N, laws), laws)
    ends = rest_at(s, start, with_drive_force(step, 0.0, NO_TIME_S), laws)
    s[at.DEFLECTION] = deflection
    return restarted(ends, True), True


@kernel
def taut_position(s: Floats, step: Step, laws: LugreLaws) -> float:
    """Return the position of the drive's end of a tendon taut without tension [mm]."""
    return unloaded_load(step.lost_N, laws) - shortening(s, laws)


@kernel
def slack_tendon(step: Step, laws: LugreLaws) -> LumpedTendon:
    """Return a slack tendon."""
    drive = EndState(Given(0.0, 0.0), 0.0, 0.0, 0.0, 0.0)
    load = EndState(Given(0.0, 0.0), unloaded_load(step.lost_N, laws), 0.0, 0.0, 0.0)
    ends = StepEnds(drive, load, 0.0)
    return LumpedTendon(ends, math.inf, math.inf, math.inf, True, True)


@kernel
def step_of_rest(
    force: float, time_s: float, position: float, rig: Rig, n: int, friction: float
) -> Step:
    """Return a step of zero length with a force at the drive [N], which is at a position [mm].

    `friction` is a factor of the friction coefficient.
    """
    losses = with_friction(losses_at(time_s, position, 0.0, 0.0, rig), friction)
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
