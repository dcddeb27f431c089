"""What the slip chain is at one moment: its nodes, the laws that hold there, what is given."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.effects.load_friction import LoadFriction
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]

DISPLACEMENT, FORCE, SPRING = 0, 1, 2  # what is given at an end
SLACK, UNSETTLED = 2, 3  # phases beside +1, 0, −1
TOLERANCE = 1e-10  # of the tension and of a segment's elongation, for rounding
BALANCED = 1e-9  # of the tension, where a law is not straight


class Boundary(NamedTuple):
    """What is given at the two ends: the kind of each."""

    drive: int
    load: int


class Laws(NamedTuple):
    """What of the rig a static problem needs; the whole rig would be copied at every call."""

    n: int  # nodes of the sheath
    preload_N: float
    load_stiffness_N_per_mm: float
    load_spring: LoadSpringNonlinearity
    load_friction: LoadFriction
    load_mass_kg: float
    drive_friction_N: float
    proximal_spring_N_per_mm: float
    friction_exponent: float
    presliding_mm: float


class Moment(NamedTuple):
    """All that changes from outside, at one moment."""

    drive: float  # displacement [mm] or tension at the sensor [N]
    load: float  # displacement [mm] or tension at the sensor [N]; unused with a spring
    pulled: float  # friction times bend in contraction [1]
    released: float  # friction times bend in loosening [1]
    viscous_N: float  # tension lost over the whole sheath to viscous friction
    lost_N: float  # preload that the load spring's anchor has lost
    step_s: float  # time since the moment before, infinite where it plays no part


PITCH = 1088  # known when compiled, so that loops over rows become vector instructions
MOST_NODES = 1000

# Rows of the state, over the nodes from 0 at the drive to n + 1 at the load: chain[X + i].
X, X_OLD = 0, PITCH  # position, now and when the last step had settled [mm]
T, T_OLD = PITCH * 2, PITCH * 3  # tension of the segment behind the node, likewise [N]
SLIP = PITCH * 4  # direction in which the node slips, 0 where it sticks
PASSES = PITCH * 5  # where it does not stick, T[i] = PASSES T[i−1] − TAKES − BRISTLE x
TAKES, BRISTLE = PITCH * 6, PITCH * 7
GIVE = PITCH * 8  # compliance of the segment behind the node [mm/N]
P, Q, R = (PITCH * row for row in range(9, 12))  # its T = (P x + Q)/R, x the node's position
SPEED = PITCH * 12  # of the load's mass when the last step had settled [mm/s]
PULLED, RELEASED = PITCH * 13, PITCH * 14  # what the node's bend leaves of the tension, e^(−a/n)
TURNED = PITCH * 15  # with presliding, the share of its limit that friction had reached
MOVED = PITCH * 16  # way since the last step, as expected, at which PASSES to BRISTLE hold [mm]
PULLED_BY, RELEASED_BY = PITCH * 17, PITCH * 18  # the node's share of friction times bend, a/n
SHARE = PITCH * 19  # of its limit that friction reaches, with its sign
T_ROSE = PITCH * 20  # by how much the tension rose in the last step [N]
LIMIT = PITCH * 21  # that share's limit, a/n at the node's tension
WRAP, RATIO = PITCH * 22, PITCH * 23  # friction times bend with its sign, and e to it
ROWS = 24
