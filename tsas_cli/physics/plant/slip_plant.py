"""The plant of a closed loop with the slip chain as its tendon; see `turntable`."""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import with_spring
from tsas_cli.physics.course import with_friction
from tsas_cli.physics.ends import losses_at
from tsas_cli.physics.plant.turntable import (
    DriveStep,
    Turntable,
    advance_turntable,
    spring_of,
    turntable_at,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.chain import advance, go_slack, pulls_at_neither_end
from tsas_cli.physics.slip.ends import drive_tangent, update_end_speeds
from tsas_cli.physics.slip.state import Moment, SlipLaws, with_drive
from tsas_cli.support.arrays import Floats


@kernel
def step_plant(
    table: Turntable, chain: Floats, before: Moment, rig: Rig, laws: SlipLaws, step: DriveStep
) -> tuple[Turntable, Moment, bool]:
    """Advance turntable, tendon and load by a step; `laws` are those of a drive by force.

    Returns the turntable, the moment of the chain after the step, and whether it converged.
    """
    p = chain[at.POSITION]
    spring = spring_of(table, p, rig, step)
    converged, now, x, f_in = True, before, spring.x, table.f_in
    mass_speed = chain[at.SPEED_BEFORE]
    if spring.touches:
        losses = with_friction(losses_at(step.time_s, p, table.speed, 0.0, rig), step.friction)
        now = Moment(spring.force, 0.0, losses, step.h)
        drive = laws.drive
        stiffness = drive.spring_N_per_mm + spring.stiffness + step.beside.slope
        driven = with_drive(laws, with_spring(drive, drive.given, stiffness, step.beside.ahead))
        converged = advance(chain, before, now, driven)
        if pulls_at_neither_end(chain, now, laws):
            go_slack(chain, now, laws)
            chain[at.POSITION_BEFORE], chain[at.SPEED_BEFORE] = p, mass_speed
            slope, value = drive_tangent(chain, now, driven)
            friction_N = chain[at.SLIP] * drive.friction_N
            chain[at.POSITION] = (spring.force - friction_N - value) / slope
            update_end_speeds(chain, step.h, laws.n)
            chain[at.POSITION_BEFORE] = chain[at.POSITION]
        x, f_in = turntable_at(chain[at.POSITION], spring)
    speed = (chain[at.POSITION] - p) / step.h
    return advance_turntable(table, x, f_in, speed, step.h), now, converged
