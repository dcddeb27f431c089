"""The dynamic chain's state: its rows, the rig's constants, the inputs of one step."""

from typing import NamedTuple

from tsas_cli.effects.pulley_friction import PulleyFriction
from tsas_cli.effects.stribeck_friction import StribeckFriction
from tsas_cli.physics.boundary import DriveEnd, LoadEnd
from tsas_cli.physics.bristles import Bristle
from tsas_cli.physics.mesh import PITCH

# Rows of the state, over the nodes from 0 at the drive to n + 1 at the load: s[POSITION + i].
# Positions are relative to the drive, where its position is given: 4 times fewer steps.
POSITION, POSITION_1, POSITION_2 = (PITCH * row for row in range(3))  # after the last three [mm]
SPEED, SPEED_1 = (PITCH * row for row in range(3, 5))  # absolute, after the last two steps [mm/s]
DEFLECTION, DEFLECTION_1 = (PITCH * row for row in range(5, 7))  # of the bristles, likewise [mm]
RATE, RATE_PREDICTED = PITCH * 7, PITCH * 8  # of POSITION, iterate and prediction [mm/s]
FRICTION = PITCH * 9  # [N]
DEFLECTION_NEW, POSITION_NEW = PITCH * 10, PITCH * 11  # at the present RATE
POSITION_HISTORY = PITCH * 12  # in y = POSITION_HISTORY + gh RATE; the next two likewise
SPEED_HISTORY, DEFLECTION_HISTORY = PITCH * 13, PITCH * 14
STIFFNESS, DAMPING = PITCH * 15, PITCH * 16  # of the segment behind the node [N/mm, N s/mm]
TENSION = PITCH * 17  # = TENSION_HISTORY + TENSION_SLOPE (RATE − RATE behind) [N]
TENSION_HISTORY, TENSION_SLOPE = PITCH * 18, PITCH * 19
LIMIT, LIMIT_BY_T, LIMIT_BY_V = (PITCH * row for row in range(20, 23))  # of friction, derivatives
LOWER, DIAGONAL, UPPER, RESIDUAL = (PITCH * row for row in range(23, 27))  # Newton's equations
MINOR, SCALED, INCREMENT = (PITCH * row for row in range(27, 30))  # elimination and solution
# Of the load, at 0 the force of its hysteresis [N], at 1 the stretch of its relaxing spring [mm].
LOAD_STATE, LOAD_STATE_1 = PITCH * 30, PITCH * 31  # after the last two steps
LOAD_STATE_HISTORY, LOAD_STATE_NEW = PITCH * 32, PITCH * 33  # in the formula, at the present RATE
ROWS = 34


class Lump(NamedTuple):
    """The laws of one lump."""

    mass: float  # [t]
    bristle: Bristle
    friction_exponent: float
    friction_slope: float  # along the sheath, over the mean
    drag_N: float  # friction that is independent of the tension
    stribeck: StribeckFriction


class LugreLaws(NamedTuple):
    """The constants of the rig for every step."""

    n: int
    preload_N: float
    lump: Lump
    pulleys: PulleyFriction
    end_bristle: Bristle  # of the drive's and of the load's friction
    drive: DriveEnd
    load: LoadEnd


class Formula(NamedTuple):
    """A step and the two before it, infinite where there was none; y = near y1 − far y2 + gh w."""

    h: float  # [s]
    h1: float
    h2: float
    gh: float
    near: float
    far: float


class Given(NamedTuple):
    """The given quantity at an end of the tendon and its rate [mm or N, per s]."""

    value: float
    rate: float


class Step(NamedTuple):
    """One step: its length in the formula y = POSITION_HISTORY + gh RATE, and its end."""

    gh: float  # [s]
    drive: Given
    load: Given  # unused with a spring
    frame: Given  # origin of the positions [mm], its speed by the same formula [mm/s]
    pulled: float  # friction over the mean tension of a lump's two sides in contraction [1]
    released: float  # and in loosening [1]
    lost_N: float  # preload lost at the load spring's anchor
