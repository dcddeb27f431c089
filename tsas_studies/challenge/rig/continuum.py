"""The tendon in its sheath as a continuum with Dahl friction, solved by finite volumes.

Nodes cluster towards both ends (Chebyshev–Lobatto points); each node carries the friction of the
half cells beside it, each cell one tension. Friction per length is μ κ T (T/F0)^n φ, where the
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
from tsas_studies.challenge.rig.give import Path, given
from tsas_studies.challenge.rig.load_end import AT_REST, Load, LoadState, extra_force, moved
from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.surface import Past, Surface, remembered, roughness

MAX_ITERATIONS = 100
MAX_CUTS = 10
SHORTEST_PART = 1e-4
LEAST_RATIO = 0.01  # of T/F0, below which friction no longer depends on it


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


def nodes(length_mm: float, cells: int) -> Floats:
    """Return the node positions from 0 (drive) to the length (load), shape (cells + 1,)."""
    return 0.5 * length_mm * (1.0 - np.cos(np.pi * np.arange(cells + 1) / cells))


@compiled
def run(
    tendon: Tendon, path: Path, time: Floats, x_in: Floats, mu: Floats, q: Floats
) -> tuple[Floats, Floats, Floats, Floats, int]:
    """March through all samples, starting at rest at the preload with x_in = 0.

    `time` [s] and the fields of `Ends` are of each sample, shape (m,) with m ≥ 2.

    Return the tensions at the drive and at the load [N], the displacement of the sheath's distal
    end [mm] and the state of the load's guide, shape (m,) each, and the number of samples before
    the tendon went slack or a step did not converge.
    """
    m, n = x_in.size, tendon.bend.size
    state = at_rest(n, tendon.surface)
    load = AT_REST
    t_in, t_out = np.full(m, np.nan), np.full(m, np.nan)
    u_end, guide = np.full(m, np.nan), np.full(m, np.nan)
    before = Ends(0.0, mu[0], tendon.p * tendon.preload)
    bent = 1.0
    for i in range(m):
        h = time[max(i, 1)] - time[max(i, 1) - 1]
        now = Ends(x_in[i] - (path.jumped + path.crept), mu[i] * bent, q[i])
        converged, load, last = _advance(state, load, tendon, before, now, h)
        if not converged:
            return t_in, t_out, u_end, guide, i
        before = now
        t_in[i], t_out[i] = last
        u_end[i], guide[i] = state.u[-1], load.guide
        if min(t_in[i], t_out[i]) <= 0.0:
            return t_in, t_out, u_end, guide, i
        path = given(path, t_in[i], tendon.preload, h)
        bent = 1.0 + tendon.friction.shift_per_N * (t_in[i] - tendon.preload)
    return t_in, t_out, u_end, guide, m


@compiled
def at_rest(n: int, law: Surface) -> State:
    """Return the state of n nodes before the first sample."""
    start = roughness(Past(0.0, 0.0, 0.0), 0.0, law)
    return State(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.full(n, start))


@compiled
def stretched(
    state: State, tendon: Tendon, ends: Ends, h: float
) -> tuple[bool, Floats, float, float]:
    """Return whether a step between two displacements converged, what moved, and both tensions."""
    good, du = _solve(state, AT_REST, tendon, ends, h)
    tension, _, e, w = _stretched(state, du, tendon, ends.mu, h)
    return good, du, _at_drive(tension, e, w), _at_load(tension, e, w)


@compiled
def _advance(
    state: State, load: LoadState, tendon: Tendon, before: Ends, now: Ends, h: float
) -> tuple[bool, LoadState, tuple[float, float]]:
    """Go from one sample to the next, in smaller parts where the whole does not converge.

    Returns whether all converged, the load's state, and the tensions at both ends.
    """
    done, part = 0.0, 1.0
    ends = (0.0, 0.0)
    while done < 1.0:
        to = min(1.0, done + part)
        here = Ends(
            before.x_in + to * (now.x_in - before.x_in),
            before.mu + to * (now.mu - before.mu),
            before.q + to * (now.q - before.q),
        )
        step = (to - done) * h
        converged, du = _solve(state, load, tendon, here, step)
        if converged:
            tension, _, e, w = _stretched(state, du, tendon, here.mu, step)
            ends = (_at_drive(tension, e, w), _at_load(tension, e, w))
            y = state.u[-1] + du[-1] - tendon.c_out * (ends[1] - tendon.preload)
            load = moved(tendon.load, load, y, step)
            keep(state, du, tendon, step)
            done = to
        else:
            part *= 0.5
            if part < SHORTEST_PART:
                return False, load, ends
    return True, load, ends


@compiled
def keep(state: State, du: Floats, tendon: Tendon, h: float) -> None:
    """Add a solved displacement to the state."""
    forgotten = 1.0 - np.exp(-h / tendon.friction.stribeck_memory_s)
    for j in range(du.size):
        state.phi[j] = _turned(du[j], j, state, tendon)
        state.u[j] += du[j]
        past = Past(state.speed[j], state.age[j], state.slid[j])
        past = remembered(past, du[j], h, forgotten, tendon.surface)
        state.speed[j], state.age[j], state.slid[j] = past
        state.rough[j] = roughness(past, state.u[j], tendon.surface)


@compiled
def _rise(speed: float, tendon: Tendon) -> float:
    """Return by what factor friction is larger at this speed [mm/s] than at a high one."""
    excess = tendon.friction.stribeck_excess
    if excess == 0.0:
        return 1.0
    share = speed / tendon.friction.stribeck_velocity_mm_per_s
    return float(1.0 + excess * np.exp(-(share**tendon.friction.stribeck_power)))


@compiled
def _turned(du: float, i: int, state: State, tendon: Tendon) -> float:
    """Return the friction state of node i after a displacement du [mm]."""
    rise = _rise(state.speed[i], tendon)
    if tendon.friction.round_mm > 0.0:
        return bouc_wen(du, state.phi[i], tendon.delta, rise)
    return dahl(du, state.phi[i], tendon.delta, tendon.friction.asymmetry, rise)


@compiled
def _turned_slope(du: float, i: int, state: State, tendon: Tendon) -> float:
    """Return by how much that changes per displacement [1/mm]."""
    rise = _rise(state.speed[i], tendon)
    if tendon.friction.round_mm > 0.0:
        return bouc_wen_slope(du, state.phi[i], tendon.delta, rise)
    return dahl_slope(du, state.phi[i], tendon.delta, tendon.friction.asymmetry, rise)


@compiled
def _load_factor(i: int, tension: Floats, tendon: Tendon) -> float:
    """Return (T/F0)^n of node i."""
    exponent = tendon.friction.load_exponent
    if exponent == 0.0:
        return 1.0
    mean = 0.5 * (tension[max(i - 1, 0)] + tension[min(i, tension.size - 1)])
    return float(max(mean / tendon.preload, LEAST_RATIO) ** exponent)


@compiled
def _stretched(
    state: State, du: Floats, tendon: Tendon, mu: float, h: float
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return tension [N] and stiffness [N/mm] of each cell; by node e and the other friction [N].

    Friction by the tension is 2 e T, e = μ θ φ (T/F0)^n / 2; the other one is viscous or drag.
    """
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
        turned = _turned(du[i], i, state, tendon)
        e[i] = 0.5 * mu * tendon.bend[i] * turned * _load_factor(i, tension, tendon)
        e[i] *= state.rough[i]
        w[i] += tendon.drag[i] * turned
    return tension, k, e, w


@compiled
def _at_drive(tension: Floats, e: Floats, w: Floats) -> float:
    """Return the tension on the drive's side of the first node [N]."""
    return float((tension[0] * (1.0 + e[0]) + w[0]) / (1.0 - e[0]))


@compiled
def _at_load(tension: Floats, e: Floats, w: Floats) -> float:
    """Return the tension on the load's side of the last node [N]."""
    return float((tension[-1] * (1.0 - e[-1]) - w[-1]) / (1.0 + e[-1]))


@compiled
def _unbalanced(
    state: State,
    load: LoadState,
    du: Floats,
    tension: Floats,
    e: Floats,
    w: Floats,
    tendon: Tendon,
    ends: Ends,
    h: float,
) -> tuple[Floats, float]:
    """Return what pulls each node towards the drive [N], and the slope of the load's addition.

    Inside T_{i−1} (1 − e) − T_i (1 + e) − w.
    """
    u = state.u
    pull = np.empty(u.size)
    at_drive = _at_drive(tension, e, w)
    pull[0] = ends.x_in - u[0] - du[0] - tendon.c_in * (at_drive - tendon.preload)
    for i in range(1, u.size - 1):
        pull[i] = tension[i - 1] * (1.0 - e[i]) - tension[i] * (1.0 + e[i])
        pull[i] -= w[i]
    at_load = _at_load(tension, e, w)
    y = u[-1] + du[-1] - tendon.c_out * (at_load - tendon.preload)
    force, slope = extra_force(tendon.load, load, y, h)
    pull[-1] = tendon.p * at_load - ends.q - tendon.r * (u[-1] + du[-1]) - force
    return pull, slope


@compiled
def _newton_change(
    state: State,
    du: Floats,
    tension: Floats,
    k: Floats,
    e: Floats,
    pull: Floats,
    load_slope: float,
    tendon: Tendon,
    mu: float,
    h: float,
) -> Floats:
    """Solve the tridiagonal Newton equations for the change of du."""
    n = du.size
    upper, change = np.empty(n), np.empty(n)
    p, r = tendon.p + tendon.c_out * load_slope, tendon.r + load_slope
    for i in range(n):
        slope = _turned_slope(du[i], i, state, tendon)
        lag = tendon.viscous[i] / h + tendon.drag[i] * slope
        slope *= 0.5 * mu * tendon.bend[i] * _load_factor(i, tension, tendon) * state.rough[i]
        by_load = e[i] * tendon.friction.load_exponent
        if i == 0:
            below = 0.0
            above = -tendon.c_in * k[0] * (1.0 + e[0]) / (1.0 - e[0])
            above -= tendon.c_in * k[0] * 2.0 * by_load / (1.0 - e[0]) ** 2
            diagonal = 1.0 - above + tendon.c_in * tension[0] * 2.0 * slope / (1.0 - e[0]) ** 2
            diagonal += tendon.c_in * lag / (1.0 - e[0])
        elif i < n - 1:
            below = -k[i - 1] * (1.0 - e[i] - by_load)
            above = -k[i] * (1.0 + e[i] + by_load)
            diagonal = -below - above + slope * (tension[i - 1] + tension[i]) + lag
        else:
            below, above = -p * k[-1] * (1.0 - e[i]) / (1.0 + e[i]), 0.0
            below += p * k[-1] * 2.0 * by_load / (1.0 + e[i]) ** 2
            diagonal = r - below + p * tension[-1] * 2.0 * slope / (1.0 + e[i]) ** 2
            diagonal += p * lag / (1.0 + e[i])
        change[i] = pull[i]
        if i > 0:
            diagonal -= below * upper[i - 1]
            change[i] -= below * change[i - 1]
        upper[i] = above / diagonal
        change[i] /= diagonal
    for i in range(n - 2, -1, -1):
        change[i] -= upper[i] * change[i + 1]
    return change


@compiled
def _solve(
    state: State, load: LoadState, tendon: Tendon, ends: Ends, h: float
) -> tuple[bool, Floats]:
    """Find du by Newton's method from du = 0; return whether it converged, and du.

    While all nodes move one way the residual is concave with an M-matrix as Jacobian, and the
    iteration is monotone. Otherwise a step is cut where the nodes would be pulled back, but for
    the gentle law of Bouc and Wen, which whole steps solve.
    """
    cuts = 1 if tendon.friction.round_mm > 0.0 else MAX_CUTS
    du = np.zeros(state.u.size)
    tension, k, e, w = _stretched(state, du, tendon, ends.mu, h)
    pull, slope = _unbalanced(state, load, du, tension, e, w, tendon, ends, h)
    for _ in range(MAX_ITERATIONS):
        change = _newton_change(state, du, tension, k, e, pull, slope, tendon, ends.mu, h)
        work = np.dot(change[1:-1], pull[1:-1])
        part = 1.0
        for _ in range(cuts):
            trial = du + part * change
            tension, k, e, w = _stretched(state, trial, tendon, ends.mu, h)
            pull, slope = _unbalanced(state, load, trial, tension, e, w, tendon, ends, h)
            after = np.dot(change[1:-1], pull[1:-1])
            if work <= 0.0 or after >= -0.5 * work:
                break
            part *= work / (work - after)
        du = trial
        stretch = np.abs(np.diff(change)) * tendon.k
        if np.abs(change).max() < 1e-5 * tendon.delta and stretch.max() < 1e-7:
            return True, du
    return False, du
