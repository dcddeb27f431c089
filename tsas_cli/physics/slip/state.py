"""The slip chain's state: its rows, the rig's constants, the inputs, and the nodes at rest."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.effects.antagonist import Antagonist
from tsas_cli.effects.presliding import Presliding, bristle_compliance
from tsas_cli.effects.pulley_friction import PulleyFriction
from tsas_cli.effects.stribeck_friction import StribeckFriction
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import (
    DISPLACEMENT,
    Boundary,
    DriveEnd,
    LoadEnd,
    drive_end,
    free_drive,
    load_end,
    with_given,
)
from tsas_cli.physics.course import Losses
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

TOLERANCE = 1e-10  # of the tension and of a segment's elongation, for rounding
BALANCED = 1e-9  # of the tension, where a law is not linear


class SlipLaws(NamedTuple):
    """The constants of the rig for a static problem; the whole rig would be copied at each call."""

    n: int  # nodes of the sheath
    preload_N: float  # of the tendon
    load_preload_N: float  # of the load
    scale_mm: float  # elongation of a node's segment at the preload
    friction_exponent: float
    friction_slope: float  # along the sheath, over the mean
    pulleys: PulleyFriction
    presliding: Presliding
    bristle_mm_per_N: float  # compliance of a node's bristles of fixed stiffness
    stribeck: StribeckFriction
    drive: DriveEnd
    load: LoadEnd
    antagonist: Antagonist


class Moment(NamedTuple):
    """The inputs at one moment."""

    drive: float  # displacement [mm] or tension at the sensor [N]
    load: float  # likewise; unused with a spring
    losses: Losses
    step_s: float  # time since the moment before, infinite for a quasi-static step


# Rows of the state, over the nodes from 0 at the drive to n + 1 at the load: chain[TENSION + i].
# A "segment" is the one behind the node; "before" is the end of the last step.
POSITION, POSITION_BEFORE = 0, PITCH  # [mm]
TENSION, TENSION_BEFORE = PITCH * 2, PITCH * 3  # of the segment [N]
SLIP = PITCH * 4  # direction in which the node slips, 0 where it sticks
FACTOR = PITCH * 5  # where it slips, T[i] = FACTOR T[i−1] − DROP − DROP_SLOPE x
DROP, DROP_SLOPE = PITCH * 6, PITCH * 7
COMPLIANCE = PITCH * 8  # of the segment [mm/N]
SWEEP_P, SWEEP_Q, SWEEP_R = (PITCH * row for row in range(9, 12))  # segment's T = (P x + Q)/R
SPEED_BEFORE = PITCH * 12  # of the masses of drive and load [mm/s]
RATIO_PULLED, RATIO_RELEASED = PITCH * 13, PITCH * 14  # of both tensions in full slip, e^(−a/n)
SHARE_BEFORE = PITCH * 15  # with presliding, SHARE at the end of the last step
TRAVEL = PITCH * 16  # since the last step, the point of the tangents FACTOR to DROP_SLOPE [mm]
WRAP_PULLED, WRAP_RELEASED = PITCH * 17, PITCH * 18  # the node's share of friction times bend, a/n
SHARE = PITCH * 19  # ratio of friction to its limit, with its sign
TENSION_RISE = PITCH * 20  # in the last step [N]
WRAP_LIMIT = PITCH * 21  # a/n at the node's tension, in the direction of SHARE
WRAP_SIGNED, RATIO = PITCH * 22, PITCH * 23  # friction times bend with its sign, its exponential
ELEMENT, STRETCH = PITCH * 24, PITCH * 24 + 1  # force of the load's hysteresis, before [N], and
# stretch of its relaxing spring [mm]
SPEED = PITCH * 25  # at which the node has slid within the frictional lag [mm/s]
POSITION_EARLIER, SPEED_EARLIER = PITCH * 26, PITCH * 27  # of the masses, a step before "before"
STEP_BEFORE = PITCH * 24 + 2  # length of the last step [s]
LENGTH = PITCH * 28  # travel over which the friction of a node reverses [mm]
ROWS = 29
# An antagonist's rows follow, with node 0 at the load and n + 1 at the drive: the pair is one loop,
# on which the load pulls, and x and the directions of slip are those of the first tendon.
SECOND = PITCH * ROWS
IS_SLACK, WAS_SLACK = PITCH * 24, PITCH * 24 + 1  # of the second tendon, which has no load
FIRST_IS_SLACK, FIRST_WAS_SLACK = SECOND + SPEED_BEFORE, SECOND + SPEED_BEFORE + 1


@kernel
def chain_at_rest(rig: Rig, n: int) -> Floats:
    """Return the chain at uniform preload, with that of an antagonist behind it if there is one."""
    second_N = rig.effects.antagonist.preload_N
    tendons = 2 if second_N > 0.0 else 1
    chain = np.empty(tendons * SECOND)
    for row in range(tendons * ROWS):
        for j in range(n + 2):
            chain[PITCH * row + j] = 0.0
    for j in range(n + 2):
        chain[TENSION + j] = chain[TENSION_BEFORE + j] = rig.preload_N + second_N
    chain[STEP_BEFORE] = math.inf
    set_compliances(chain, rig, n)
    if second_N > 0.0:
        second = chain[SECOND:]
        for j in range(n + 2):
            second[TENSION + j] = second[TENSION_BEFORE + j] = second_N
            second[COMPLIANCE + j] = chain[COMPLIANCE + max(n - j, 0)]
    return chain


@kernel
def set_compliances(chain: Floats, rig: Rig, n: int) -> None:
    """Set the compliances of the segments; the load's end has that of the last one."""
    compliances = segment_compliances(rig, n)
    for j in range(n + 2):
        chain[COMPLIANCE + j] = compliances[min(j, n)]


@kernel
def slip_laws(rig: Rig, n: int, boundary: Boundary) -> SlipLaws:
    """Return the constants of the rig for a static problem, with the given ends."""
    antagonist = rig.effects.antagonist
    preload_N = rig.preload_N + antagonist.preload_N
    wrap = rig.friction_coefficient * rig.total_bend_rad / n
    return SlipLaws(
        n,
        preload_N,
        rig.preload_N,
        rig.sheath_length_mm * preload_N / rig.tendon_stiffness_N / n + 1e-9,
        rig.effects.load_dependent_friction.exponent,
        rig.effects.uneven_friction.slope,
        rig.effects.pulley_friction,
        rig.effects.presliding,
        bristle_compliance(rig.effects.presliding, wrap),
        rig.effects.stribeck_friction,
        drive_end(rig, boundary.drive),
        load_end(rig, boundary.load),
        antagonist,
    )


@kernel
def with_drive(laws: SlipLaws, drive: DriveEnd) -> SlipLaws:
    """Return the laws with another end at the drive."""
    return SlipLaws(
        laws.n,
        laws.preload_N,
        laws.load_preload_N,
        laws.scale_mm,
        laws.friction_exponent,
        laws.friction_slope,
        laws.pulleys,
        laws.presliding,
        laws.bristle_mm_per_N,
        laws.stribeck,
        drive,
        laws.load,
        laws.antagonist,
    )


@kernel
def laws_of_second(laws: SlipLaws) -> SlipLaws:
    """Return the laws of an antagonist, whose both ends have given displacements."""
    return SlipLaws(
        laws.n,
        laws.antagonist.preload_N,
        laws.load_preload_N,
        laws.scale_mm,
        laws.friction_exponent,
        -laws.friction_slope,
        PulleyFriction(laws.pulleys.load_loss, laws.pulleys.drive_loss),
        laws.presliding,
        laws.bristle_mm_per_N,
        laws.stribeck,
        free_drive(DISPLACEMENT),
        with_given(laws.load, DISPLACEMENT),
        laws.antagonist,
    )
