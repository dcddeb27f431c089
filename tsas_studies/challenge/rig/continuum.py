"""The tendon as a continuum with Dahl friction, by finite volumes: its records and laws.

Nodes cluster towards both ends (Chebyshev–Lobatto points); each node carries the friction of the
half cells beside it, each cell one tension. Friction per length is μ κ T (T/10 N)^n φ, where the
state φ follows Dahl's law (dahl.py); viscous friction w v of each node's own speed v and its drag,
d φ, add to it. At δ = 5e-6 mm a front is a few mm wide.

Units: mm, N, s, tonne. Displacements u count towards the drive, from rest at the preload.
"""

from typing import NamedTuple

import numpy as np

from tsas_studies.challenge.rig.bouc_wen import bouc_wen, bouc_wen_slope
from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.dahl import dahl, dahl_slope
from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.load_end import Load
from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.surface import Surface

MU_AT_N = 10.0  # tension at which the friction coefficient is the stated one
LEAST_N = 0.1  # below it friction no longer depends on the tension
GROWS_AT_N = 10.0  # tension at which a length that grows with it is the stated one


class Tendon(NamedTuple):
    """What stays the same over a run.

    bend: bend angle of each node [rad]; k: stiffness of each cell [N/mm]; c_in: compliance
    between the drive and the sheath [mm/N]; p, r: the distal end, p T_out = q + r u_end + what
    the load adds; c_out: compliance between the sheath and the load; viscous, drag: friction of
    each node by its speed [N s/mm] and at any tension [N]; surface: what friction depends on at
    each place; stiffening: a cell's stiffness grows by this share per newton [1/N].
    """

    bend: Floats
    k: Floats
    c_in: float
    p: float
    r: float
    preload: float
    delta: float
    c_out: float
    load: Load
    friction: Friction
    viscous: Floats
    drag: Floats
    surface: Surface
    stiffening: float


class Ends(NamedTuple):
    """What changes: displacement of the drive [mm], friction coefficient, q of the distal end."""

    x_in: float
    mu: float
    q: float


class State(NamedTuple):
    """What a sample leaves to the next, of each node.

    Displacement, friction state, what `Past` holds, and the factor on friction that follows.
    """

    u: Floats
    phi: Floats
    speed: Floats
    age: Floats
    slid: Floats
    rough: Floats


class Cells(NamedTuple):
    """A tendon during a step: tension [N] and stiffness [N/mm] of each cell, friction of each node.

    Friction by the tension is 2 e T, e = μ θ φ (T/10 N)^n / 2; the other one, w [N], is viscous or
    drag.
    """

    tension: Floats
    k: Floats
    e: Floats
    w: Floats


def nodes(length_mm: float, cells: int) -> Floats:
    """Return the node positions from 0 (drive) to the length (load), shape (cells + 1,)."""
    return 0.5 * length_mm * (1.0 - np.cos(np.pi * np.arange(cells + 1) / cells))


@compiled
def stribeck_rise(speed: float, tendon: Tendon) -> float:
    """Return by what factor friction is larger at this speed [mm/s] than at a high one."""
    excess = tendon.friction.stribeck_excess
    if excess == 0.0:
        return 1.0
    share = speed / tendon.friction.stribeck_velocity_mm_per_s
    return float(1.0 + excess * np.exp(-(share**tendon.friction.stribeck_power)))


@compiled
def length_of(i: int, state: State, tendon: Tendon) -> float:
    """Return δ of node i [mm], by the tension at the step before where it grows with that."""
    grows = tendon.friction.presliding_mm * tendon.friction.presliding_growth
    if grows == 0.0:
        return tendon.delta
    stretch = 0.0
    for j in (max(i - 1, 0), min(i, state.u.size - 2)):
        stretch += 0.5 * tendon.k[j] * (state.u[j] - state.u[j + 1])
    return float(tendon.delta + grows * (max(tendon.preload + stretch, 0.0) / GROWS_AT_N - 1.0))


@compiled
def turned(du: float, i: int, state: State, tendon: Tendon) -> float:
    """Return the friction state of node i after a displacement du [mm]."""
    rise, delta = stribeck_rise(state.speed[i], tendon), length_of(i, state, tendon)
    if tendon.friction.round_mm > 0.0:
        return bouc_wen(du, state.phi[i], delta, rise)
    return dahl(du, state.phi[i], delta, tendon.friction.asymmetry, rise)


@compiled
def turned_slope(du: float, i: int, state: State, tendon: Tendon) -> float:
    """Return by how much that changes per displacement [1/mm]."""
    rise, delta = stribeck_rise(state.speed[i], tendon), length_of(i, state, tendon)
    if tendon.friction.round_mm > 0.0:
        return bouc_wen_slope(du, state.phi[i], delta, rise)
    return dahl_slope(du, state.phi[i], delta, tendon.friction.asymmetry, rise)


@compiled
def load_factor(i: int, tension: Floats, tendon: Tendon) -> float:
    """Return (T/10 N)^n of node i."""
    exponent = tendon.friction.load_exponent
    if exponent == 0.0:
        return 1.0
    mean = 0.5 * (tension[max(i - 1, 0)] + tension[min(i, tension.size - 1)])
    return float((max(mean, LEAST_N) / MU_AT_N) ** exponent)


@compiled
def cells_of(state: State, du: Floats, tendon: Tendon, mu: float, h: float) -> Cells:
    """Return the tendon after a displacement du of each node [mm], shape (n,)."""
    u, stiffening, w = state.u, tendon.stiffening, tendon.viscous * du / h
    tension, k, e = np.empty(u.size - 1), tendon.k.copy(), np.empty(u.size)
    for i in range(u.size - 1):
        more = du[i] - du[i + 1]
        if stiffening == 0.0:
            tension[i] = tendon.preload + k[i] * (u[i] - u[i + 1] + more)
        else:  # the tangent at the step before, so that a step stays linear in the stretch
            grown = np.exp(stiffening * k[i] * (u[i] - u[i + 1]))
            k[i] *= grown
            tension[i] = tendon.preload + (grown - 1.0) / stiffening + k[i] * more
    for i in range(u.size):
        phi = turned(du[i], i, state, tendon)
        e[i] = 0.5 * mu * tendon.bend[i] * phi * load_factor(i, tension, tendon)
        e[i] *= state.rough[i]
        w[i] += tendon.drag[i] * phi
    return Cells(tension, k, e, w)


@compiled
def at_drive(cells: Cells) -> float:
    """Return the tension on the drive's side of the first node [N]."""
    e = cells.e[0]
    return float((cells.tension[0] * (1.0 + e) + cells.w[0]) / (1.0 - e))


@compiled
def at_load(cells: Cells) -> float:
    """Return the tension on the load's side of the last node [N]."""
    e = cells.e[-1]
    return float((cells.tension[-1] * (1.0 - e) - cells.w[-1]) / (1.0 + e))
