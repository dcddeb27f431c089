"""The same equations compiled, and their Jacobian, so that no solver waits for Python."""

import math

import numba

from benchmarks.lugre_rivals.drives import Floats

LOWER, UPPER = 5, 3  # bandwidths of the Jacobian
BANDS = LOWER + UPPER + 1
UNDERFLOW = 40.0  # exp of its negative is less than what rounding loses

compiled = numba.njit(cache=True, error_model="numpy")


@compiled
def motion_at(t: float, sines: Floats, pieces: Floats) -> tuple[float, float, float]:
    """Return x_in [mm], v_in [mm/s] and a_in [mm/s²]."""
    x = v = a = 0.0
    for row in range(sines.shape[0]):
        A, omega, phi = sines[row]
        sin, cos = math.sin(omega * t + phi), math.cos(omega * t + phi)
        x += A * (sin - math.sin(phi))
        v += A * omega * cos
        a -= A * omega**2 * sin
    if pieces.shape[0] > 0:
        row = min(max(int(t / pieces[1, 0]), 0), pieces.shape[0] - 1)
        start, cubic, square, slope, value = pieces[row]
        s = t - start
        x = ((cubic * s + square) * s + slope) * s + value
        v = (3.0 * cubic * s + 2.0 * square) * s + slope
        a = 6.0 * cubic * s + 2.0 * square
    return x, v, a


@compiled
def rate(
    t: float, state: Floats, out: Floats, constants: Floats, sines: Floats, pieces: Floats
) -> None:
    """Write the state's rate of change to `out`; `ode.rate` says what is computed."""
    m, k, c, kL, F0, S0, S1, S2, tanh, e, vs = constants
    x_in, v_in, a_in = motion_at(t, sines, pieces)
    n = state.size // 3
    before = F0 - 2.0 * (k * state[0] + c * state[1])
    for i in range(n):
        y, w, z = state[3 * i], state[3 * i + 1], state[3 * i + 2]
        if i < n - 1:
            behind = F0 + k * (y - state[3 * i + 3]) + c * (w - state[3 * i + 4])
        else:
            behind = F0 + kL * (state[3 * n] + x_in)
        v = w + v_in
        q = (v / vs) ** 2
        stribeck = 1.0 + e * math.exp(-q) if q < UNDERFLOW else 1.0
        dz = v - abs(v) * z * S0 / (abs(before + behind) * tanh * stribeck)
        out[3 * i] = w
        out[3 * i + 1] = (before - behind - S0 * z - S1 * dz - S2 * v) / m - a_in
        out[3 * i + 2] = dz
        before = behind
    y, w, y_load = state[3 * n - 3], state[3 * n - 2], state[3 * n]
    out[3 * n] = w + (2.0 * k * (y - y_load) - kL * (y_load + x_in)) / (2.0 * c)


@compiled
def jacobian(
    t: float, state: Floats, columns: Floats, constants: Floats, sines: Floats, pieces: Floats
) -> None:
    """Write ∂rate_i/∂state_j to columns[j, i − j + UPPER]; what is zero is left alone."""
    m, k, c, kL, F0, S0, S1, S2, tanh, e, vs = constants
    x_in, v_in, _ = motion_at(t, sines, pieces)
    n = state.size // 3
    before = F0 - 2.0 * (k * state[0] + c * state[1])
    for i in range(n):
        Y, W, Z = 3 * i, 3 * i + 1, 3 * i + 2
        last = i == n - 1
        if last:
            behind = F0 + kL * (state[3 * n] + x_in)
        else:
            behind = F0 + k * (state[Y] - state[Y + 3]) + c * (state[W] - state[W + 3])
        v, z = state[W] + v_in, state[Z]
        q = (v / vs) ** 2
        excess = e * math.exp(-q) if q < UNDERFLOW else 0.0
        g = abs(before + behind) * tanh * (1.0 + excess)
        r = abs(v) * S0 / g
        by_T = r * z / (before + behind)  # ∂dz/∂T, the same on both sides
        by_stribeck = 2.0 * excess * v / vs**2 / (1.0 + excess)
        by_v = 1.0 - math.copysign(S0, v) * z / g - r * z * by_stribeck

        columns[W, Y - W + UPPER] = 1.0
        columns[Z, W - Z + UPPER] = (S1 * r - S0) / m
        columns[Z, UPPER] = -r
        to_w, from_w = (1.0 - S1 * by_T) / m, (-1.0 - S1 * by_T) / m  # by T before, T behind
        ahead, own = 2.0 if i == 0 else 1.0, 0.0 if last else 1.0  # stiffness to either side over k
        w_by_T, z_by_T = own * from_w - ahead * to_w, (own - ahead) * by_T
        columns[Y, W - Y + UPPER] = k * w_by_T
        columns[Y, Z - Y + UPPER] = k * z_by_T
        columns[W, UPPER] = c * w_by_T - (S2 + S1 * by_v) / m
        columns[W, Z - W + UPPER] = c * z_by_T + by_v
        if i > 0:
            columns[Y - 3, W - Y + 3 + UPPER] = k * to_w
            columns[Y - 3, Z - Y + 3 + UPPER] = k * by_T
            columns[W - 3, W - W + 3 + UPPER] = c * to_w
            columns[W - 3, Z - W + 3 + UPPER] = c * by_T
        if last:
            columns[3 * n, W - 3 * n + UPPER] = kL * from_w
            columns[3 * n, Z - 3 * n + UPPER] = kL * by_T
        else:
            columns[Y + 3, W - Y - 3 + UPPER] = -k * from_w
            columns[Y + 3, Z - Y - 3 + UPPER] = -k * by_T
            columns[W + 3, UPPER - 3] = -c * from_w
            columns[W + 3, Z - W - 3 + UPPER] = -c * by_T
        before = behind
    columns[3 * n - 3, 3 + UPPER] = k / c
    columns[3 * n - 2, 2 + UPPER] = 1.0
    columns[3 * n, UPPER] = -(2.0 * k + kL) / (2.0 * c)


@compiled
def spread(columns: Floats, J: Floats) -> None:
    """Write what `jacobian` gives to a full matrix."""
    size = columns.shape[0]
    for column in range(size):
        for row in range(max(0, column - UPPER), min(size, column + LOWER + 1)):
            J[row, column] = columns[column, row - column + UPPER]
