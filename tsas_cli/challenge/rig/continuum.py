"""The tendon in its sheath as a continuum with Dahl friction, solved by finite volumes.

Nodes cluster towards both ends (Chebyshev–Lobatto points); each node carries the friction of the
half cells beside it, each cell one tension. Friction per length is μ κ T φ, where the state φ
follows Dahl's law, rate-independent, φ → sgn(Δu) + (φ − sgn(Δu)) exp(−|Δu|/δ) over a
displacement Δu of one sign (P. R. Dahl, "Solid friction damping of mechanical vibrations", AIAA
Journal 14, 1976). As δ → 0 this is Coulomb friction; at δ = 5e-6 mm a front is a few mm wide.

Units: mm, N. Displacements u count towards the drive, from the state at rest at the preload.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.challenge.rig.compiled import compiled

Floats = npt.NDArray[np.float64]

MAX_ITERATIONS = 100
MAX_CUTS = 10
SHORTEST_PART = 1e-4


class Tendon(NamedTuple):
    """What stays the same over a run.

    bend: bend angle of each node [rad]; k: stiffness of each cell [N/mm]; c_in: compliance of
    the free tendon at the drive [mm/N]; p, r: the distal end, p T_out = q + r u_end.
    """

    bend: Floats
    k: Floats
    c_in: float
    p: float
    r: float
    preload: float
    delta: float


class Ends(NamedTuple):
    """What changes: displacement of the drive [mm], friction coefficient, q of the distal end."""

    x_in: float
    mu: float
    q: float


def nodes(length_mm: float, cells: int) -> Floats:
    """Return the node positions from 0 (drive) to the length (load), shape (cells + 1,)."""
    return 0.5 * length_mm * (1.0 - np.cos(np.pi * np.arange(cells + 1) / cells))


@compiled
def run(tendon: Tendon, x_in: Floats, mu: Floats, q: Floats) -> tuple[Floats, Floats, Floats, int]:
    """March through all samples, starting at rest at the preload with x_in = 0.

    Parameters
    ----------
    tendon
        What stays the same.
    x_in, mu, q
        The fields of `Ends` at each sample, each of shape (m,).

    Returns
    -------
    f_in, f_out, u_end
        Tensions at the drive and at the load [N] and displacement of the sheath's distal end
        [mm], each of shape (m,).
    solved
        The number of samples before the tendon went slack or a step did not converge.
    """
    m, n = x_in.size, tendon.bend.size
    u, phi = np.zeros(n), np.zeros(n)
    f_in, f_out, u_end = np.full(m, np.nan), np.full(m, np.nan), np.full(m, np.nan)
    before = Ends(0.0, mu[0], tendon.p * tendon.preload)
    for i in range(m):
        now = Ends(x_in[i], mu[i], q[i])
        if not _advance(u, phi, tendon, before, now):
            return f_in, f_out, u_end, i
        before = now
        tension, e = _state(u, phi, np.zeros(n), tendon, now.mu)
        f_in[i] = tension[0] * (1.0 + e[0]) / (1.0 - e[0])
        f_out[i] = tension[-1] * (1.0 - e[-1]) / (1.0 + e[-1])
        u_end[i] = u[-1]
        if min(f_in[i], f_out[i]) <= 0.0:
            return f_in, f_out, u_end, i
    return f_in, f_out, u_end, m


@compiled
def _advance(u: Floats, phi: Floats, tendon: Tendon, before: Ends, now: Ends) -> bool:
    """Go from one sample to the next, in smaller parts where the whole does not converge."""
    done, part = 0.0, 1.0
    while done < 1.0:
        to = min(1.0, done + part)
        here = Ends(
            before.x_in + to * (now.x_in - before.x_in),
            before.mu + to * (now.mu - before.mu),
            before.q + to * (now.q - before.q),
        )
        converged, du = _solve(u, phi, tendon, here)
        if converged:
            for j in range(u.size):
                phi[j] = dahl(du[j], phi[j], tendon.delta)
                u[j] += du[j]
            done = to
        else:
            part *= 0.5
            if part < SHORTEST_PART:
                return False
    return True


@compiled
def dahl(du: float, phi: float, delta: float) -> float:
    """Return the friction state after a displacement du [mm] of one sign."""
    sign = np.sign(du)
    return float(sign + (phi - sign) * np.exp(-abs(du) / delta))


@compiled
def _dahl_slope(du: float, phi: float, delta: float) -> float:
    """Return ∂φ/∂du, at du = 0 the larger one of both sides."""
    if du == 0.0:
        return (1.0 + abs(phi)) / delta
    sign = np.sign(du)
    return float((1.0 - sign * phi) / delta * np.exp(-abs(du) / delta))


@compiled
def _state(u: Floats, phi: Floats, du: Floats, tendon: Tendon, mu: float) -> tuple[Floats, Floats]:
    """Return the tension of each cell [N], and e = μ θ φ / 2 of each node."""
    tension, e = np.empty(u.size - 1), np.empty(u.size)
    for i in range(u.size):
        e[i] = 0.5 * mu * tendon.bend[i] * dahl(du[i], phi[i], tendon.delta)
    for i in range(u.size - 1):
        stretch = u[i] - u[i + 1] + (du[i] - du[i + 1])
        tension[i] = tendon.preload + tendon.k[i] * stretch
    return tension, e


@compiled
def _unbalanced(
    u: Floats, du: Floats, tension: Floats, e: Floats, tendon: Tendon, ends: Ends
) -> Floats:
    """Return what pulls each node towards the drive: T_{i−1} (1 − e) − T_i (1 + e) inside [N]."""
    pull = np.empty(u.size)
    at_drive = tension[0] * (1.0 + e[0]) / (1.0 - e[0])
    pull[0] = ends.x_in - u[0] - du[0] - tendon.c_in * (at_drive - tendon.preload)
    for i in range(1, u.size - 1):
        pull[i] = tension[i - 1] * (1.0 - e[i]) - tension[i] * (1.0 + e[i])
    at_load = tension[-1] * (1.0 - e[-1]) / (1.0 + e[-1])
    pull[-1] = tendon.p * at_load - ends.q - tendon.r * (u[-1] + du[-1])
    return pull


@compiled
def _newton_change(
    phi: Floats, du: Floats, tension: Floats, e: Floats, pull: Floats, tendon: Tendon, mu: float
) -> Floats:
    """Solve the tridiagonal Newton equations for the change of du."""
    n, k = du.size, tendon.k
    upper, change = np.empty(n), np.empty(n)
    for i in range(n):
        slope = 0.5 * mu * tendon.bend[i] * _dahl_slope(du[i], phi[i], tendon.delta)
        if i == 0:
            below, above = 0.0, -tendon.c_in * k[0] * (1.0 + e[0]) / (1.0 - e[0])
            diagonal = 1.0 - above + tendon.c_in * tension[0] * 2.0 * slope / (1.0 - e[0]) ** 2
        elif i < n - 1:
            below, above = -k[i - 1] * (1.0 - e[i]), -k[i] * (1.0 + e[i])
            diagonal = -below - above + slope * (tension[i - 1] + tension[i])
        else:
            below, above = -tendon.p * k[-1] * (1.0 - e[i]) / (1.0 + e[i]), 0.0
            diagonal = tendon.r - below + tendon.p * tension[-1] * 2.0 * slope / (1.0 + e[i]) ** 2
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
def _solve(u: Floats, phi: Floats, tendon: Tendon, ends: Ends) -> tuple[bool, Floats]:
    """Find du by Newton's method from du = 0; return whether it converged, and du.

    While all nodes move one way the residual is concave with an M-matrix as Jacobian, and the
    iteration is monotone. Otherwise a step is cut where the nodes would be pulled back.
    """
    du = np.zeros(u.size)
    tension, e = _state(u, phi, du, tendon, ends.mu)
    pull = _unbalanced(u, du, tension, e, tendon, ends)
    for _ in range(MAX_ITERATIONS):
        change = _newton_change(phi, du, tension, e, pull, tendon, ends.mu)
        work = np.dot(change[1:-1], pull[1:-1])
        part = 1.0
        for _ in range(MAX_CUTS):
            trial = du + part * change
            tension, e = _state(u, phi, trial, tendon, ends.mu)
            pull = _unbalanced(u, trial, tension, e, tendon, ends)
            after = np.dot(change[1:-1], pull[1:-1])
            if work <= 0.0 or after >= -0.5 * work:
                break
            part *= work / (work - after)
        du = trial
        stretch = np.abs(np.diff(change)) * tendon.k
        if np.abs(change).max() < 1e-5 * tendon.delta and stretch.max() < 1e-7:
            return True, du
    return False, du
