"""The tendon in its sheath as a continuum with Dahl friction, solved by finite volumes.

Nodes cluster towards both ends (Chebyshev–Lobatto points); each node carries the friction of the
half cells beside it, each cell one tension. Friction per length is μ κ T φ, where the state φ
follows Dahl's law, rate-independent, φ → sgn(Δu) + (φ − sgn(Δu)) exp(−|Δu|/δ) over a
displacement Δu of one sign (P. R. Dahl, "Solid friction damping of mechanical vibrations", AIAA
Journal 14, 1976). As δ → 0 this is Coulomb friction; at δ = 5e-6 mm a front is a few mm wide.

Units: mm, N. Displacements u count towards the drive, from the state at rest at the preload.
"""

import numpy as np
from numba import njit

MAX_NEWTON = 60
MAX_HALVINGS = 20


def nodes(length_mm, cells):
    """Return the node positions from 0 (drive) to the length (load), shape (cells + 1,)."""
    return 0.5 * length_mm * (1.0 - np.cos(np.pi * np.arange(cells + 1) / cells))


@njit(cache=True)
def run(x_in, friction, load_q, load_p, load_r, bend, k, c_in, F0, delta):
    """March through all samples, starting at rest at the preload with x_in = 0.

    Parameters
    ----------
    x_in
        Displacement of the drive [mm], shape (m,).
    friction
        μ at each sample, shape (m,).
    load_q, load_p, load_r
        The distal end: p T_out = q + r u_end, with q of shape (m,).
    bend
        Bend angle that belongs to each node [rad], shape (cells + 1,).
    k
        Stiffness of each cell [N/mm], shape (cells,).
    c_in
        Compliance of the free tendon at the drive [mm/N].
    F0, delta
        Preload [N]; presliding length [mm].

    Returns
    -------
    f_in, f_out, u_end, ok
        Tensions at the drive and at the load [N] and displacement of the sheath's distal end
        [mm], each of shape (m,); False when a step did not converge or the tendon went slack.
    """
    m, n = x_in.size, bend.size
    u, phi, du = np.zeros(n), np.zeros(n), np.zeros(n)
    work = np.empty((2, n))
    f_in, f_out, u_end = np.empty(m), np.empty(m), np.empty(m)
    x0, mu0, q0 = 0.0, friction[0], load_p * F0
    for i in range(m):
        x1, mu1, q1 = x_in[i], friction[i], load_q[i]
        done, part, halvings = 0.0, 1.0, 0
        while done < 1.0:
            to = min(1.0, done + part)
            x, mu, q = x0 + to * (x1 - x0), mu0 + to * (mu1 - mu0), q0 + to * (q1 - q0)
            direction = np.sign(x1 - x0)
            ok = False
            for guess in (direction, 0.0):
                ok = ok or _step(
                    u, phi, du, work, guess, x + c_in * F0, mu, q, load_p, load_r, bend, k, c_in,
                    F0, delta,
                )  # fmt: skip
            if not ok:
                part *= 0.5
                halvings += 1
                if halvings > MAX_HALVINGS:
                    return f_in, f_out, u_end, False
                continue
            for j in range(n):
                phi[j] = dahl(du[j], phi[j], delta)
                u[j] += du[j]
            done = to
        x0, mu0, q0 = x1, mu1, q1
        e = 0.5 * mu1 * bend[0] * phi[0]
        f_in[i] = (F0 + k[0] * (u[0] - u[1])) * (1.0 + e) / (1.0 - e)
        e = 0.5 * mu1 * bend[-1] * phi[-1]
        f_out[i] = (F0 + k[-1] * (u[-2] - u[-1])) * (1.0 - e) / (1.0 + e)
        u_end[i] = u[-1]
        if min(f_in[i], f_out[i]) <= 0.0:
            return f_in, f_out, u_end, False
    return f_in, f_out, u_end, True


@njit(cache=True)
def dahl(du, phi, delta):
    """Return the friction state after a displacement du [mm] of one sign."""
    sign = np.sign(du)
    return sign + (phi - sign) * np.exp(-abs(du) / delta)


@njit(cache=True)
def _dahl_slope(du, phi, delta, direction):
    """Return ∂φ/∂du; at du = 0 the one towards `direction`, or the larger one if that is 0."""
    sign = np.sign(du) if du != 0.0 else direction
    if sign == 0.0:
        return (1.0 + abs(phi)) / delta
    return (1.0 - sign * phi) / delta * np.exp(-abs(du) / delta)


@njit(cache=True)
def _moved(du, change, direction):
    """Return du after a Newton change that stops at 0, where the slope jumps."""
    if direction == 0.0 and du * (du + change) < 0.0:
        return 0.0
    return du + change


@njit(cache=True)
def _step(u, phi, du, work, direction, q_in, mu, q, p, r, bend, k, c_in, F0, delta):
    """Find du by Newton's method from du = 0; return whether it converged.

    Where all nodes move one way the residual is concave with an M-matrix as Jacobian, and the
    iteration is monotone. Balance of node i: T_{i−1} (1 − e) = T_i (1 + e), e = μ θ_i φ_i / 2.
    """
    n = u.size
    upper, rhs = work[0], work[1]
    du[:] = 0.0
    for _ in range(MAX_NEWTON):
        left, k_left = 0.0, 0.0
        for i in range(n):
            half = 0.5 * mu * bend[i]
            e = half * dahl(du[i], phi[i], delta)
            e1 = half * _dahl_slope(du[i], phi[i], delta, direction)
            if i < n - 1:
                k_right = k[i]
                right = F0 + k_right * (u[i] + du[i] - u[i + 1] - du[i + 1])
            if i == 0:
                g = (1.0 + e) / (1.0 - e)
                below = 0.0
                above = -c_in * k_right * g
                diagonal = 1.0 - above + c_in * right * 2.0 * e1 / (1.0 - e) ** 2
                residual = q_in - u[0] - du[0] - c_in * right * g
            elif i < n - 1:
                below = -k_left * (1.0 - e)
                above = -k_right * (1.0 + e)
                diagonal = -below - above + e1 * (left + right)
                residual = left * (1.0 - e) - right * (1.0 + e)
            else:
                g = (1.0 - e) / (1.0 + e)
                below = -p * k_left * g
                above = 0.0
                diagonal = r - below + p * left * 2.0 * e1 / (1.0 + e) ** 2
                residual = p * left * g - q - r * (u[i] + du[i])
            if i > 0:
                diagonal -= below * upper[i - 1]
                residual -= below * rhs[i - 1]
            upper[i] = above / diagonal
            rhs[i] = residual / diagonal
            left, k_left = right, k_right
        largest, tension = abs(rhs[n - 1]), 0.0
        du[n - 1] = _moved(du[n - 1], rhs[n - 1], direction)
        for i in range(n - 2, -1, -1):
            rhs[i] -= upper[i] * rhs[i + 1]
            du[i] = _moved(du[i], rhs[i], direction)
            largest = max(largest, abs(rhs[i]))
            tension = max(tension, k[i] * abs(rhs[i] - rhs[i + 1]))
        if not np.isfinite(largest):
            return False
        if largest < 1e-5 * delta and tension < 1e-7:
            return True
    return False
