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
from tsas_cli.physics.ends import friction_without_speed
from tsas_cli.physics.lugre.balance import balance_drive
from tsas_cli.physics.lugre.ends import Ends, ends_after, sensor_share
from tsas_cli.physics.lugre.input import lump_share
from tsas_cli.physics.lugre.pace import allowed, attempt, change_of, fitted
from tsas_cli.physics.lugre.slack import limp, load_without_pull, shortening
from tsas_cli.physics.lugre.start import NO_TIME_S, law_of, lay_down, lay_out, set_segments
from tsas_cli.physics.lugre.state import (
    DIAGONAL,
    FRICTION,
    REST,
    ROWS,
    T_BY_W,
    Y_PAST,
    Z_NEW,
    Z_PAST,
    Floats,
    Law,
    Step,
    T,
    V,
    W,
    Y,
    Z,
)
from tsas_cli.physics.lugre.step import MOST_ITERATIONS, formula_of, keep
from tsas_cli.physics.plant.turntable import Actuator, Turntable, moved, pulled_to, reach_of
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as slip
from tsas_cli.physics.slip.state import DISPLACEMENT, FORCE, PITCH, SPRING, Boundary

TOLERANCE = 1e-4  # of a tension: what a step of the lumps may add to its error
LEAVES = 1e-7  # what Newton's method may leave: more shakes a turntable that is at rest
ROUGH = 1.0  # the same where that is not to be had
CAREFUL_TRIES, MOST_TRIES = 200, 300  # of steps of the lumps in one of the plant


class Tendon(NamedTuple):
    """The tendon beside its lumps: both ends, and how steps go on."""

    ends: Ends
    h: float  # the step to take next, and the two before it, infinite where there was none [s]
    h1: float
    h2: float
    touched: bool  # by the drive, which is not within its play
    slack: bool


def no_lumps() -> Floats:
    """Return room for lumps, for `lay_lumps` to lay them down."""
    return np.empty(ROWS * PITCH)


@kernel
def lay_lumps(s: Floats, chain: Floats, f_in: float, rig: Rig, n: int) -> Tendon:
    """Lay lumps down at rest where a slip chain is, with a force at the drive [N]."""
    law, start = law_of(rig, n), np.empty((2, n + 2))
    lay_out(s, rig, n)
    for j in range(n + 2):
        start[0, j], start[1, j] = chain[slip.X + j], chain[slip.T + j]
    step = given_by(f_in, 0.0, rig, n)
    ends = lay_down(s, start, step, Boundary(FORCE, SPRING), law)
    return hung(step, law) if s[Y] < taut_place(s, step, law) else begun(ends, True)


@kernel
def with_rig(s: Floats, tendon: Tendon, rig: Rig, n: int) -> Tendon:
    """Go on with another rig."""
    set_segments(s, rig, n)
    return Tendon(tendon.ends, math.inf, math.inf, math.inf, tendon.touched, tendon.slack)


@kernel
def begun(ends: Ends, touched: bool) -> Tendon:
    """Return a tendon from whose ends the next step is a first one."""
    return Tendon(ends, math.inf, math.inf, math.inf, touched, False)


@kernel
def step_lumped_plant(
    table: Turntable,
    s: Floats,
    tendon: Tendon,
    time_s: float,
    rig: Rig,
    law: Law,
    actuator: Actuator,
    h: float,
) -> tuple[Turntable, Tendon, bool]:
    """Move turntable, tendon and load by h to a time, the motor being there already.

    Returns the turntable, the tendon, and whether its steps were solved and within their error.
    Where Newton's method fails the tendon is left behind, for the next step to catch up with.
    """
    p = s[Y]
    reach = reach_of(table, p, rig, actuator, h)
    step = given_by(reach.drive, time_s, rig, law.n)
    if tendon.touched != reach.touches and not tendon.slack:
        tendon = begun(tendon.ends, reach.touches)
    settled, arrived, x, f_in = True, True, reach.x, table.f_in
    boundary, held = Boundary(DISPLACEMENT, SPRING), law
    if reach.touches:
        boundary, held = Boundary(FORCE, SPRING), held_law(law, reach.share)
        if tendon.slack:
            tendon, settled = pull_slack(s, step, held, h)
    tension = tendon.ends.f_in
    if not tendon.slack:
        before = table.f_in + reach.share * p
        tendon, arrived, settled = advance_lumps(s, tendon, before, step, boundary, held, h)
    if not reach.touches:
        f_in += tendon.ends.f_in - tension
    else:
        if tendon.ends.f_in < 0.0 and s[Y] <= taut_place(s, step, law):
            s[Y] = (step.drive - s[FRICTION]) / held.proximal_spring_N_per_mm
            tendon = hung(step, law)
        if arrived:
            x, f_in = pulled_to(s[Y], reach)
    return moved(table, x, f_in, (s[Y] - p) / h, h), tendon, settled


@kernel
def advance_lumps(
    s: Floats,
    tendon: Tendon,
    before: float,
    step: Step,
    boundary: Boundary,
    law: Law,
    h: float,
) -> tuple[Tendon, bool, bool]:
    """Move the lumps by h, the force at the drive going straight from before to the step's.

    Returns the tendon, whether it has arrived, and whether every step was within its error, which
    does not count any more after many tries.
    """
    ends, length, h1, h2, _, _ = tendon
    length, done, tolerance = min(length, h), 0.0, TOLERANCE
    for tries in range(MOST_TRIES):
        if tries == CAREFUL_TRIES:
            length, h1, h2, tolerance = h - done, math.inf, math.inf, ROUGH
        length, lands = fitted(length, h - done)
        part = 1.0 if lands else (done + length) / h
        formula = formula_of(length, h1, h2)
        to = driven(step, before + part * (step.drive - before), formula.gh)
        most = allowed(ends, law, tolerance, LEAVES)
        off, _ = attempt(s, to, formula, boundary, law, most)
        change = change_of(off, most, formula)
        if off < most.error_N:
            ends = ends_after(s, to, law)
            keep(s, to, law)
            done, length, h1, h2 = done + length, length * change, length, h1
            if lands:
                return (
                    Tendon(ends, length, h1, h2, tendon.touched, False),
                    True,
                    tolerance == TOLERANCE,
                )
        else:
            length *= change
    return begun(ends, tendon.touched), False, False


@kernel
def pull_slack(s: Floats, step: Step, law: Law, h: float) -> tuple[Tendon, bool]:
    """Move the end of a slack tendon; where that would stretch it, lay it down taut instead.

    Returns the tendon and whether the end's place was found.
    """
    place, deflection = s[Y], s[Z]
    s[Y_PAST], s[Z_PAST], s[W] = place, deflection, 0.0
    s[T] = s[T_BY_W] = 0.0
    step, settled = driven(step, step.drive, h), False
    for _ in range(MOST_ITERATIONS):
        balance_drive(s, step, Boundary(FORCE, SPRING), law)
        settled = abs(s[REST]) <= 1e-9 * law.preload_N
        if settled:
            break
        s[W] += s[REST] / s[DIAGONAL]
    s[Y], s[V], s[Z] = place + h * s[W], s[W], s[Z_NEW]
    if s[Y] <= taut_place(s, step, law):
        return hung(step, law), settled
    start = limp(s, load_without_pull(step.lost_N, law), law)
    ends = lay_down(s, start, driven(step, 0.0, NO_TIME_S), Boundary(FORCE, SPRING), law)
    s[Z] = deflection
    return begun(ends, True), True


@kernel
def taut_place(s: Floats, step: Step, law: Law) -> float:
    """Return where the drive's end of the tendon is when it is straight without tension [mm]."""
    return load_without_pull(step.lost_N, law) - shortening(s, law)


@kernel
def hung(step: Step, law: Law) -> Tendon:
    """Return a tendon that hangs slack."""
    load = load_without_pull(step.lost_N, law)
    ends = Ends(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, load, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Tendon(ends, math.inf, math.inf, math.inf, True, True)


@kernel
def given_by(drive: float, time_s: float, rig: Rig, n: int) -> Step:
    """Return a step of no time, at whose end a force pulls at the drive [N]."""
    pulled, released, lost_N = friction_without_speed(time_s, 0.0, rig)
    limits = lump_share(pulled, n), lump_share(released, n)
    return Step(NO_TIME_S, drive, 0.0, 0.0, 0.0, 0.0, 0.0, limits[0], limits[1], lost_N)


@kernel
def driven(step: Step, drive: float, gh: float) -> Step:
    """Return a step with another force at the drive and another length."""
    return Step(gh, drive, 0.0, 0.0, 0.0, 0.0, 0.0, step.pulled, step.released, step.lost_N)


@kernel
def tension_at_load(tendon: Tendon, law: Law) -> float:
    """Return what a force sensor at the load feels [N]."""
    share = sensor_share(Boundary(FORCE, SPRING), law)
    return tendon.ends.f_out - share * tendon.ends.guide


@kernel
def held_law(law: Law, stiffness: float) -> Law:
    """Return the law with a spring more between the tendon's end and the ground [N/mm]."""
    return Law(
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
