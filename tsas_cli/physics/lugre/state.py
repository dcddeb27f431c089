"""The dynamic chain's state: its rows, the laws that hold there, what one step is given."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.effects.load_friction import LoadFriction
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.effects.stribeck_friction import StribeckFriction
from tsas_cli.physics.bristles import Bristle
from tsas_cli.physics.slip.state import PITCH

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]

# Rows of the state, over the nodes from 0 at the drive to n + 1 at the load: s[Y + i]. Positions
# are relative to the drive, where that is given: 4 times fewer steps.
Y, Y1, Y2 = (PITCH * row for row in range(3))  # position after the last three steps [mm]
V, V1 = (PITCH * row for row in range(3, 5))  # speed, absolute, after the last two [mm/s]
Z, Z1 = (PITCH * row for row in range(5, 7))  # deflection of the bristles, likewise [mm]
W, W_GUESS = PITCH * 7, PITCH * 8  # relative speed, as sought and as guessed [mm/s]
FRICTION = PITCH * 9  # [N]
Z_NEW, Y_NEW = PITCH * 10, PITCH * 11  # at the speeds sought
Y_PAST, V_PAST, Z_PAST = (PITCH * row for row in range(12, 15))  # history in y = Y_PAST + gh w
STIFFNESS, DAMPING = PITCH * 15, PITCH * 16  # of the segment behind the node [N/mm, N s/mm]
T, T_PAST, T_BY_W = (PITCH * row for row in range(17, 20))  # T = T_PAST + T_BY_W (w − w behind) [N]
LIMIT, LIMIT_BY_T, LIMIT_BY_V = (PITCH * row for row in range(20, 23))  # of friction
LOWER, DIAGONAL, UPPER, REST = (PITCH * row for row in range(23, 27))  # Newton's equations
MINOR, SCALED, CHANGE = (PITCH * row for row in range(27, 30))  # their elimination and solution
ROWS = 30


class Law(NamedTuple):
    """What of the rig holds at every step."""

    n: int
    preload_N: float
    lump_mass: float  # [t]
    bristle: Bristle  # of one lump
    end_bristle: Bristle  # of the drive's and of the load's friction
    friction_exponent: float
    stribeck: StribeckFriction
    load_stiffness_N_per_mm: float
    load_spring: LoadSpringNonlinearity
    load_friction: LoadFriction
    load_mass_kg: float
    drive_friction_N: float
    proximal_spring_N_per_mm: float


class Formula(NamedTuple):
    """A step and the two before it, infinite where there was none; y = near y1 − far y2 + gh w."""

    h: float  # [s]
    h1: float
    h2: float
    gh: float
    near: float
    far: float


class Step(NamedTuple):
    """One step: its length in the formula y = Y_PAST + gh w, and what is given at its end."""

    gh: float  # [s]
    drive: float  # displacement [mm] or tension [N]
    drive_rate: float
    load: float  # likewise; unused with a spring
    load_rate: float
    position: float  # of the frame that positions are relative to [mm]
    speed: float  # of that frame, by the same formula [mm/s]
    pulled: float  # friction over the mean tension of a lump's two sides in contraction [1]
    released: float  # and in loosening [1]
    lost_N: float  # preload that the load spring's anchor has lost
