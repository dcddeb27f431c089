"""One static problem of the slip chain: which nodes slip, and where everything then is.

Given which nodes slip, the chain is a row of affine relations. From the load backwards each
segment's tension is T = (p x + q)/r with the position x of the node before it: a slipping node
multiplies, a node that sticks starts anew (or adds its bristle), a segment adds its compliance.
From the drive forwards the positions follow. No sweep divides in the recursion, and none can
blow up: p and r are positive. Then every node is held against its own law, and those that break
it are revised (an active-set form of the semi-smooth Newton method).

Signs: x grows towards the drive; a node that slips towards the drive (+1) has less tension on the
load's side. Where the net tension is negative (a pair of antagonistic tendons seen as one),
friction follows its magnitude.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.effects.load_dependent_friction import load_factor
from tsas_cli.effects.load_friction import LoadFriction, guide_friction
from tsas_cli.effects.load_inertia import inertia_force
from tsas_cli.effects.load_spring_nonlinearity import (
    LoadSpringNonlinearity,
    spring_force,
    spring_tangent,
)
from tsas_cli.effects.presliding import bristle_stiffness
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.numerics.compiled import kernel

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]

DISPLACEMENT, FORCE, SPRING = 0, 1, 2  # what is given at an end
TOLERANCE = 1e-10  # of the tension and of a segment's elongation, for rounding
MOST_AT_ONCE = 20  # revisions of the slipping set
MOST_ONE_BY_ONE = 5  # more, for each node
BALANCED = 1e-9  # of the tension, where a law is not straight
SLIPS_ALONG_S = 0.01  # in which the mass of the load takes up its speed; a rigid one would swing on
STRONGEST = 30.0  # friction of a node times its bend, so that it passes on more than nothing
MOST_BENT = 0.5  # of the ratio that a node passes on: how far a tangent may turn it
STIFFEST_BRISTLE = 100.0  # times a segment's stiffness; more does not show on the mesh
LEAST_FRICTION = 1e-9  # of the preload, so that a bristle keeps some stiffness


class Boundary(NamedTuple):
    """What is given at the two ends: the kind of each."""

    drive: int
    load: int


class Laws(NamedTuple):
    """What of the rig a static problem needs; the whole rig would be copied at every call."""

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


# The state, a row for each over the nodes from 0 at the drive to n + 1 at the load, shape
# (ROWS, n + 2). In one array, since a compiled call counts the references of each that it is given.
X, X_OLD = 0, 1  # position, now and when the last step had settled [mm]
T, T_OLD = 2, 3  # tension of the segment behind the node, likewise [N]
SLIP = 4  # direction in which the node slips, 0 where it sticks
PASSES, TAKES = 5, 14  # where it slips, T[i] = PASSES T[i−1] − TAKES
GIVE = 6  # compliance of the segment behind the node [mm/N]
P, Q, R = 7, 8, 9  # T = (P x + Q)/R of the segment behind the node, x its position
SPEED = 10  # of the load's mass when the last step had settled [mm/s]
PULLED, RELEASED = 11, 12  # what the node's share of the bend leaves of the tension, e^(−a/n)
BRISTLE = 13  # stiffness with which the node sticks [N/mm], infinite without presliding
ROWS = 15


@kernel
def set_friction(chain: Floats, now: Moment, laws: Laws) -> None:
    """Renew what each node's friction leaves of the tension, Eq. (7) of Yang 2025 for its bend."""
    n = chain.shape[1] - 2
    pulled, released = now.pulled / n, now.released / n
    if laws.friction_exponent == 0.0:
        chain[PULLED], chain[RELEASED] = math.exp(-pulled), math.exp(-released)
        return
    for i in range(1, n + 1):
        tension = 0.5 * (chain[T, i - 1] + chain[T, i])
        factor = load_factor(tension / laws.preload_N, laws.friction_exponent)
        chain[PULLED, i] = math.exp(-min(pulled * factor, STRONGEST))
        chain[RELEASED, i] = math.exp(-min(released * factor, STRONGEST))


@kernel
def ratio_passed(direction: float, i: int, chain: Floats) -> float:
    """Return T[i]/T[i−1] of a node that slips."""
    ratio: float = chain[PULLED, i] if direction > 0.0 else chain[RELEASED, i]
    negative = chain[T, i - 1] + chain[T, i] < 0.0
    return ratio if (direction > 0.0) != negative else 1.0 / ratio


@kernel
def set_slides(chain: Floats, now: Moment, laws: Laws) -> bool:
    """Renew what all slipping nodes pass on; return whether it differs from what was used.

    Friction that depends on the tension is a tangent (Newton's method): with E = e^(∓a f/n) of the
    mean tension m of both sides, T[i] = E T[i−1] − loss, and dE/dm = ∓(a/n) E f β/m.
    """
    n = chain.shape[1] - 2
    straight = laws.friction_exponent == 0.0
    changed = False
    for i in range(1, n + 1):
        if chain[SLIP, i] == 0.0:
            continue
        ratio = ratio_passed(chain[SLIP, i], i, chain)
        loss = chain[SLIP, i] * now.viscous_N / n
        if straight:
            changed = changed or ratio != chain[PASSES, i]
            chain[PASSES, i], chain[TAKES, i] = ratio, loss
            continue
        before, behind = chain[T, i - 1], chain[T, i]
        off = behind - ratio * before + loss
        changed = changed or abs(off) > BALANCED * (abs(before) + laws.preload_N)
        mean = before + behind
        bent = math.log(ratio) * ratio * laws.friction_exponent * before / mean if mean else 0.0
        bent = min(max(bent, -MOST_BENT), MOST_BENT)
        passes = (ratio + bent) / (1.0 - bent)
        chain[PASSES, i] = passes
        chain[TAKES, i] = passes * before - behind + off / (1.0 - bent)
    return changed


@kernel
def load_law(chain: Floats, now: Moment, laws: Laws) -> tuple[float, float]:
    """Return slope and value at x = 0 of what the load pulls back with, as a tangent [N/mm, N]."""
    n = chain.shape[1] - 2
    x = chain[X, n + 1]
    shape = laws.load_spring
    slope = spring_tangent(x, laws.load_stiffness_N_per_mm, shape)
    value = spring_force(x, laws.load_stiffness_N_per_mm, shape) - slope * x
    value += laws.preload_N - now.lost_N
    mass = laws.load_mass_kg
    if mass > 0.0 and now.step_s < math.inf:  # implicit Euler, first order in the step
        per_speed = 1.0 / (SLIPS_ALONG_S + now.step_s)
        slope += inertia_force(per_speed / now.step_s, mass)
        gone = chain[X_OLD, n + 1] / now.step_s + chain[SPEED, n + 1]
        value -= inertia_force(per_speed * gone, mass)
    return slope, value


@kernel
def keep_speed(chain: Floats, step_s: float) -> None:
    """Renew the speed of the load's mass after a step."""
    speed = (chain[X, -1] - chain[X_OLD, -1]) / step_s
    share = 1.0 / (1.0 + SLIPS_ALONG_S / step_s)
    chain[SPEED, -1] += share * (speed - chain[SPEED, -1])


@kernel
def set_bristles(chain: Floats, now: Moment, laws: Laws) -> None:
    """Renew how stiffly each node sticks: its limit of friction over the presliding length."""
    n = chain.shape[1] - 2
    if laws.presliding_mm == 0.0:
        return
    for i in range(1, n + 1):
        both_sides = abs(chain[T_OLD, i - 1] + chain[T_OLD, i])
        passed = 0.5 * (chain[PULLED, i] + chain[RELEASED, i])
        limit = both_sides * (1.0 - passed) / (1.0 + passed)
        limit += now.viscous_N / n + LEAST_FRICTION * laws.preload_N
        stiffest = STIFFEST_BRISTLE / chain[GIVE, i]
        chain[BRISTLE, i] = min(bristle_stiffness(limit, laws.presliding_mm), stiffest)


@kernel
def sweep_to_drive(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> None:
    """Write each segment's tension as (p x + q)/r of the node before it, from the load on."""
    F0, n = laws.preload_N, chain.shape[1] - 2
    guide = friction_at_load(boundary, laws)
    rigid = laws.presliding_mm == 0.0
    p, q, r = 0.0, 0.0, 1.0
    held = boundary.load == DISPLACEMENT or (chain[SLIP, n + 1] == 0 and guide > 0.0)
    place = now.load if boundary.load == DISPLACEMENT else chain[X_OLD, n + 1]
    if not held:
        if boundary.load == SPRING:
            p, q = load_law(chain, now, laws)
        else:
            q = now.load
        q += chain[SLIP, n + 1] * guide
    for i in range(n + 1, 0, -1):  # node i, then the segment before it
        give = chain[GIVE, i - 1]
        if i <= n:
            held = chain[SLIP, i] == 0
            place = chain[X_OLD, i]
            if not held:
                q += chain[TAKES, i] * r
                r *= chain[PASSES, i]
            elif not rigid:
                bristle = chain[BRISTLE, i]
                p, q, r = p / r + bristle, q / r, 1.0  # without this they would outgrow a float
                q += chain[T_OLD, i - 1] - chain[T_OLD, i] - bristle * place
                held = False
        if held:
            p, q, r = 1.0, give * F0 - place, give
        else:
            q += p * give * F0
            r += p * give
        chain[P, i - 1], chain[Q, i - 1], chain[R, i - 1] = p, q, r


@kernel
def friction_at_load(boundary: Boundary, laws: Laws) -> float:
    """Return the friction of the load's guide that a moving load end feels [N]."""
    if boundary.load == SPRING:
        return guide_friction(laws.load_friction)
    return laws.load_friction.before_sensor_N if boundary.load == FORCE else 0.0


@kernel
def start_of_drive(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> float:
    """Return where the drive's end is [mm]."""
    if boundary.drive == DISPLACEMENT:
        return now.drive
    friction = laws.drive_friction_N
    if chain[SLIP, 0] == 0 and friction > 0.0:
        return float(chain[X_OLD, 0])
    p, q, r = chain[P, 0], chain[Q, 0], chain[R, 0]
    stiffness = proximal_spring_force(1.0, laws.proximal_spring_N_per_mm)
    return float(((now.drive - chain[SLIP, 0] * friction) * r - q) / (p + stiffness * r))


@kernel
def sweep_to_load(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> None:
    """Find positions and tensions, from the drive on."""
    n = chain.shape[1] - 2
    rigid = laws.presliding_mm == 0.0
    chain[X, 0] = start_of_drive(chain, now, boundary, laws)
    chain[T, 0] = (chain[P, 0] * chain[X, 0] + chain[Q, 0]) / chain[R, 0]
    for i in range(1, n + 1):
        place = chain[X, i - 1] - chain[GIVE, i - 1] * (chain[T, i - 1] - laws.preload_N)
        if chain[SLIP, i] != 0:
            chain[T, i] = chain[PASSES, i] * chain[T, i - 1] - chain[TAKES, i]
        else:
            place = chain[X_OLD, i] if rigid else place
            chain[T, i] = (chain[P, i] * place + chain[Q, i]) / chain[R, i]
        chain[X, i] = place
    chain[X, n + 1] = chain[X, n] - chain[GIVE, n] * (chain[T, n] - laws.preload_N)
    if boundary.load == DISPLACEMENT:
        chain[X, n + 1] = now.load
    elif chain[SLIP, n + 1] == 0 and friction_at_load(boundary, laws) > 0.0:
        chain[X, n + 1] = chain[X_OLD, n + 1]


@kernel
def slid_back(i: int, chain: Floats, scale: float) -> bool:
    """Say whether a slipping node has slid against its own direction, its bristle's give aside."""
    slid = chain[X, i] - chain[X_OLD, i]
    if chain[BRISTLE, i] < math.inf:
        friction = chain[T, i - 1] - chain[T, i]
        slid -= (friction - (chain[T_OLD, i - 1] - chain[T_OLD, i])) / chain[BRISTLE, i]
    return bool(chain[SLIP, i] * slid < -TOLERANCE * scale)


@kernel
def revise(chain: Floats, now: Moment, scale: float, most: int) -> int:
    """Free the nodes whose tensions exceed their friction, hold those that slip backwards.

    Returns how many nodes it revised, at most so many, from the drive on.
    """
    n = chain.shape[1] - 2
    loss = now.viscous_N / n
    revised = 0
    for i in range(1, n + 1):
        before = chain[SLIP, i]
        if before == 0.0:
            chain[SLIP, i] = pulled_loose(i, loss, chain)
        elif slid_back(i, chain, scale):
            chain[SLIP, i] = 0.0
        if chain[SLIP, i] != before:
            revised += 1
            if revised == most:
                break
    return revised


@kernel
def pulled_loose(i: int, loss: float, chain: Floats) -> float:
    """Return the direction in which the tensions pull a node that sticks, 0 where it holds."""
    margin = TOLERANCE * abs(chain[T, i - 1])
    if chain[T, i] < ratio_passed(1.0, i, chain) * chain[T, i - 1] - loss - margin:
        return 1.0
    if chain[T, i] > ratio_passed(-1.0, i, chain) * chain[T, i - 1] + loss + margin:
        return -1.0
    return 0.0


@kernel
def revise_end(i: int, pull: float, friction: float, chain: Floats, scale: float) -> bool:
    """Do the same for an end with friction that does not depend on tension."""
    if chain[SLIP, i] != 0:
        if slid_back(i, chain, scale):
            chain[SLIP, i] = 0
            return True
    elif abs(pull) > friction * (1.0 + TOLERANCE):
        chain[SLIP, i] = 1 if pull > 0.0 else -1
        return True
    return False


@kernel
def revise_ends(chain: Floats, now: Moment, boundary: Boundary, laws: Laws, scale: float) -> bool:
    """Revise the two ends, and the tangent of a load spring that is not straight."""
    n = chain.shape[1] - 2
    wrong = False
    if boundary.drive == FORCE:
        stiffness = laws.proximal_spring_N_per_mm
        pull = now.drive - chain[T, 0] - proximal_spring_force(chain[X, 0], stiffness)
        if laws.drive_friction_N > 0.0:
            wrong = revise_end(0, pull, laws.drive_friction_N, chain, scale)
    if boundary.load != DISPLACEMENT:
        pull = chain[T, n] - pulls_back(chain, now, boundary, laws)
        friction = friction_at_load(boundary, laws)
        if friction > 0.0:
            wrong = revise_end(n + 1, pull, friction, chain, scale) or wrong
        if friction == 0.0 or chain[SLIP, n + 1] != 0:
            off = abs(pull - chain[SLIP, n + 1] * friction)
            wrong = off > BALANCED * (abs(chain[T, n]) + laws.preload_N) or wrong
    return wrong


@kernel
def pulls_back(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> float:
    """Return what the load pulls back with at its present place, friction aside [N]."""
    if boundary.load == FORCE:
        return now.load
    slope, value = load_law(chain, now, laws)
    return float(slope * chain[X, chain.shape[1] - 1] + value)


@kernel
def settle(chain: Floats, now: Moment, boundary: Boundary, laws: Laws, scale: float) -> bool:
    """Find the slipping nodes at a moment; return whether the set was found."""
    n = chain.shape[1] - 2
    set_friction(chain, now, laws)
    set_bristles(chain, now, laws)
    set_slides(chain, now, laws)
    for revision in range(MOST_AT_ONCE + MOST_ONE_BY_ONE * n):
        sweep_to_drive(chain, now, boundary, laws)
        sweep_to_load(chain, now, boundary, laws)
        if laws.friction_exponent != 0.0:
            set_friction(chain, now, laws)
        most = n if revision < MOST_AT_ONCE else 1  # one by one ends where all at once cycle
        wrong = revise(chain, now, scale, most) > 0
        wrong = revise_ends(chain, now, boundary, laws, scale) or wrong
        wrong = set_slides(chain, now, laws) or wrong
        if not wrong:
            return True
    return False
