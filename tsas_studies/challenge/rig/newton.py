"""What moves the nodes of the tendon in a step: Newton's equations and their solution."""

import numpy as np

from tsas_studies.challenge.rig.compiled import compiled
from tsas_studies.challenge.rig.continuum import (
    Cells,
    Ends,
    State,
    Tendon,
    at_drive,
    at_load,
    cells_of,
    load_factor,
    turned_slope,
)
from tsas_studies.challenge.rig.load_end import LoadState, extra_force
from tsas_studies.challenge.rig.motions import Floats

MAX_ITERATIONS = 100
MAX_CUTS = 10


@compiled
def _unbalanced(
    state: State,
    load: LoadState,
    du: Floats,
    cells: Cells,
    tendon: Tendon,
    ends: Ends,
    h: float,
) -> tuple[Floats, float]:
    """Return what pulls each node towards the drive [N], and the slope of the load's addition.

    Inside T_{i−1} (1 − e) − T_i (1 + e) − w.
    """
    u, tension, e = state.u, cells.tension, cells.e
    pull = np.empty(u.size)
    pull[0] = ends.x_in - u[0] - du[0] - tendon.c_in * (at_drive(cells) - tendon.preload)
    for i in range(1, u.size - 1):
        pull[i] = tension[i - 1] * (1.0 - e[i]) - tension[i] * (1.0 + e[i])
        pull[i] -= cells.w[i]
    t_out = at_load(cells)
    y = u[-1] + du[-1] - tendon.c_out * (t_out - tendon.preload)
    force, slope = extra_force(tendon.load, load, y, h)
    pull[-1] = tendon.p * t_out - ends.q - tendon.r * (u[-1] + du[-1]) - force
    return pull, slope


@compiled
def _newton_change(
    state: State,
    du: Floats,
    cells: Cells,
    pull: Floats,
    load_slope: float,
    tendon: Tendon,
    mu: float,
    h: float,
) -> Floats:
    """Solve the tridiagonal Newton equations for the change of du."""
    n, (tension, k, e, _) = du.size, cells
    upper, change = np.empty(n), np.empty(n)
    p, r = tendon.p + tendon.c_out * load_slope, tendon.r + load_slope
    for i in range(n):
        slope = turned_slope(du[i], i, state, tendon)
        lag = tendon.viscous[i] / h + tendon.drag[i] * slope
        slope *= 0.5 * mu * tendon.bend[i] * load_factor(i, tension, tendon) * state.rough[i]
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
def solve(
    state: State, load: LoadState, tendon: Tendon, ends: Ends, h: float
) -> tuple[bool, Floats]:
    """Find du by Newton's method from du = 0; return whether it converged, and du.

    While all nodes move one way the residual is concave with an M-matrix as Jacobian, and the
    iteration is monotone. Otherwise a step is cut where the nodes would be pulled back, but for
    the gentle law of Bouc and Wen, which whole steps solve.
    """
    cuts = 1 if tendon.friction.round_mm > 0.0 else MAX_CUTS
    du = np.zeros(state.u.size)
    cells = cells_of(state, du, tendon, ends.mu, h)
    pull, slope = _unbalanced(state, load, du, cells, tendon, ends, h)
    for _ in range(MAX_ITERATIONS):
        change = _newton_change(state, du, cells, pull, slope, tendon, ends.mu, h)
        work = np.dot(change[1:-1], pull[1:-1])
        part = 1.0
        for _ in range(cuts):
            trial = du + part * change
            cells = cells_of(state, trial, tendon, ends.mu, h)
            pull, slope = _unbalanced(state, load, trial, cells, tendon, ends, h)
            after = np.dot(change[1:-1], pull[1:-1])
            if work <= 0.0 or after >= -0.5 * work:
                break
            part *= work / (work - after)
        du = trial
        stretch = np.abs(np.diff(change)) * tendon.k
        if np.abs(change).max() < 1e-5 * tendon.delta and stretch.max() < 1e-7:
            return True, du
    return False, du
