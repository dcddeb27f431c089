"""The tendon from sample to sample: solved steps, in parts where one does not converge."""

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.continuum import (
    Ends,
    State,
    Tendon,
    at_drive,
    at_load,
    cells_of,
    turned,
)
from tsas_studies.challenge.rig.give import Path, given
from tsas_studies.challenge.rig.load_end import AT_REST, LoadState, moved
from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.newton import solve
from tsas_studies.challenge.rig.surface import Past, Surface, remembered, roughness

SHORTEST_PART = 1e-4


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
    good, du = solve(state, AT_REST, tendon, ends, h)
    cells = cells_of(state, du, tendon, ends.mu, h)
    return good, du, at_drive(cells), at_load(cells)


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
        converged, du = solve(state, load, tendon, here, step)
        if converged:
            cells = cells_of(state, du, tendon, here.mu, step)
            ends = at_drive(cells), at_load(cells)
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
        state.phi[j] = turned(du[j], j, state, tendon)
        state.u[j] += du[j]
        past = Past(state.speed[j], state.age[j], state.slid[j])
        past = remembered(past, du[j], h, forgotten, tendon.surface)
        state.speed[j], state.age[j], state.slid[j] = past
        state.rough[j] = roughness(past, state.u[j], tendon.surface)
