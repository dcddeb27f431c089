"""The laws of unnamed origin in the plant of a closed loop; see `effects.laws`.

The force of the drive's law is implicit: over a step it is a spring with an offset beside the
tendon, the secant of the law from where the tendon's end is to where its speed takes it (second
order; the law's elements then follow the way that it has gone). The tension of its shares is that
of the step before.

The factor of the tendon's law is held between samples of the loop. A reversal counts in proportion
as the tendon's end moves back, wholly from a quarter of the shortest travel of the law on: a loop
moves the end to and fro within its noise, while recordings are cleaned of such reversals, and a
factor that jumps at each shakes the drive. Both laws take the speed 50 ms late, a mean such as the
speeds that they were fitted to. With 10 ms a friction that falls by 20 % lets the drive stick and
slip, and one that rises by 20 % rings on the stiffness of its gear; changes by half ring still.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.effects.laws import TRAVEL
from tsas_cli.effects.laws.drive_law import drive_law_at, drive_law_widths
from tsas_cli.effects.laws.tendon_law import STARTS, tendon_law_at
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.stops import ELEMENTS, GAPS, RATIO, move_elements
from tsas_cli.physics.plant.turntable import Tangent, Turntable
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

SPEED_LAG_S = 0.05  # of the speed that both laws take
RESOLVED = 0.25  # of the shortest travel of the tendon's law, by which the end has to move back
NEAREST = 1e-6  # of the longest travel of the drive's law, the shortest way of the secant

# The state of the laws: the line that was the drive's law in the last step [N, N/mm], the speed
# that both take [mm/s], direction of the tendon's end, its place farthest in that direction and at
# the last reversal [mm], then the memory of the elements.
AHEAD, SLOPE, SPEED, WAY, FARTHEST, REVERSED = range(6)
ITS_ELEMENTS = 6
STATE = ITS_ELEMENTS + 1 + ELEMENTS + GAPS


class PlantLaws(NamedTuple):
    """The fields of both laws in a row, and the widths of the drive's elements [mm]."""

    drive: Floats
    widths: Floats
    tendon: Floats


def plant_laws(rig: Rig) -> PlantLaws:
    """Return the laws of a rig as its plant takes them."""
    drive, tendon = rig.effects.drive_law, rig.effects.tendon_law
    return PlantLaws(np.array(drive), drive_law_widths(drive), np.array(tendon))


@kernel
def laws_at_rest(x: Floats, tension: float, laws: PlantLaws) -> Floats:
    """Return the state of the laws at rest after a motion of the tendon's end, shape (STATE,).

    From positions of the end, shape (n,) [mm], and the force at the drive without the law [N].
    """
    state = np.full(STATE, np.nan)
    state[SPEED], state[WAY], state[FARTHEST], state[REVERSED] = 0.0, 0.0, x[0], -math.inf
    for p in x:
        move_elements(p, laws.widths, state[ITS_ELEMENTS:])
        follow_end(state, p, laws)
    force = drive_law_at(laws.drive, state[ITS_ELEMENTS:], x[-1], 0.0, tension)
    state[AHEAD], state[SLOPE] = force, 0.0
    return state


@kernel
def beside_drive(state: Floats, p: float, table: Turntable, h: float, laws: PlantLaws) -> Tangent:
    """Return the force of the drive's law over a step h as a line over the end's position, at p."""
    memory = state[ITS_ELEMENTS:]
    move_elements(p, laws.widths, memory)
    state[SPEED] += -math.expm1(-h / SPEED_LAG_S) * (table.speed - state[SPEED])
    tension = table.f_in - state[AHEAD] - state[SLOPE] * p
    here = drive_law_at(laws.drive, memory, p, state[SPEED], tension)
    rise = math.copysign(max(abs(table.speed * h), NEAREST * laws.drive[TRAVEL]), table.speed)
    ahead = memory.copy()
    move_elements(p + rise, laws.widths, ahead)
    there = drive_law_at(laws.drive, ahead, p + rise, state[SPEED], tension)
    state[SLOPE] = (there - here) / rise
    state[AHEAD] = here - state[SLOPE] * p
    return Tangent(state[AHEAD], state[SLOPE])


@kernel
def friction_of_tendon(state: Floats, p: float, laws: PlantLaws) -> float:
    """Return the factor of the friction coefficient with the tendon's end at p."""
    follow_end(state, p, laws)
    back = (state[FARTHEST] - p) * state[WAY]
    kept = tendon_law_at(laws.tendon, p, abs(p - state[REVERSED]), state[SPEED])
    turned = tendon_law_at(laws.tendon, p, back, state[SPEED])
    share: float = back / resolved_mm(laws)
    return kept + share * (turned - kept)


@kernel
def resolved_mm(laws: PlantLaws) -> float:
    """Return by how much the tendon's end has to move back for a reversal [mm]."""
    longest: float = laws.tendon[TRAVEL]
    return RESOLVED * longest * RATIO ** (STARTS - 1)


@kernel
def follow_end(state: Floats, p: float, laws: PlantLaws) -> None:
    """Update the reversals of the tendon's end; the first motion is none."""
    moved = p - state[FARTHEST]
    if moved * state[WAY] > 0.0:
        state[FARTHEST] = p
    elif abs(moved) > resolved_mm(laws):
        if state[WAY] != 0.0:
            state[REVERSED] = state[FARTHEST]
        state[WAY], state[FARTHEST] = math.copysign(1.0, moved), p
