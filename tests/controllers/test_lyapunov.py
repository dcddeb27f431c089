"""The argument of Eqs. (53) to (55) along the ideal drive (37): V never grows.

φ1 x⃛ + φ3 ẍ + φ2 ẋ + d1 = u, with exact rates and a boundary layer far below s.
"""

import numpy as np
import pytest

from tsas_cli.controllers.adaptive_sliding_mode import AdaptiveSlidingMode, adaptive_sliding_mode
from tsas_cli.controllers.signals import Signals
from tsas_cli.controllers.sliding_mode import Phi, Surface, distance

TRUE = np.array([0.004, 12.0, 0.05])
SURFACE = Surface(c1=30.0, c2=11.0, epsilon=1.0, ks=0.05, width=0.2)
START = (0.005, 18.0, 0.02)
PSI = (1e-6, 0.004, 1e-4)
LOW, HIGH = (0.0005, 1.8, 0.002), (0.05, 180.0, 0.2)
STEP_S = 1e-3


def wanted(t):
    """Return x_inv and its three rates at a time."""
    return np.array([np.sin(4.0 * t), 4 * np.cos(4 * t), -16 * np.sin(4 * t), -64 * np.cos(4 * t)])


def seen_at(t, x):
    place, v, a, jerk = wanted(t)
    e, de, dde = np.array([place, v, a]) - x
    return Signals(e, e, de, dde, v, a, jerk, 0.0, False)


def law_of(psi=PSI, epsilon=1.0):
    return AdaptiveSlidingMode(
        SURFACE._replace(epsilon=epsilon), Phi(*START), Phi(*LOW), Phi(*HIGH), Phi(*psi)
    )


def rates(t, y, law, disturbance):
    """Return the rates of x, ẋ, ẍ and of the three estimates."""
    step_s, memory = 1e-4, y[3:].copy()
    u = adaptive_sliding_mode(seen_at(t, y[:3]), law, memory, step_s)
    jerk = (u - disturbance(t) - TRUE[2] * y[2] - TRUE[1] * y[1]) / TRUE[0]
    return np.array([y[1], y[2], jerk, *((memory - y[3:]) / step_s)])


def lyapunov(law, disturbance, *, seconds=0.4):
    """Return V and s along a run that begins off the wanted motion."""
    y = np.array([0.05, 0.0, 0.0, *START])
    times, rows, h = np.arange(0.0, seconds, STEP_S), [y], STEP_S
    for t in times[:-1]:  # Runge and Kutta's method of fourth order
        k1 = rates(t, y, law, disturbance)
        k2 = rates(t + 0.5 * h, y + 0.5 * h * k1, law, disturbance)
        k3 = rates(t + 0.5 * h, y + 0.5 * h * k2, law, disturbance)
        k4 = rates(t + h, y + h * k3, law, disturbance)
        y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        rows.append(y)
    x, estimates = np.array(rows).T[:3], np.array(rows).T[3:]
    s = np.array([distance(seen_at(t, x[:, i]), SURFACE) for i, t in enumerate(times)])
    off = TRUE[:, None] - estimates
    return 0.5 * TRUE[0] * s**2 + np.sum(off**2 / (2.0 * np.array(PSI)[:, None]), axis=0), s


def pushing(t):
    return 0.8 * np.sin(9.0 * t)


@pytest.mark.parametrize("disturbance", [lambda _: 0.0, lambda _: -0.8, pushing])
def test_v_never_grows_while_epsilon_exceeds_the_disturbance(disturbance):
    V, s = lyapunov(law_of(), disturbance)
    outside = np.minimum(np.abs(s[1:]), np.abs(s[:-1])) > SURFACE.width
    assert outside.mean() > 0.05
    assert (np.diff(V)[outside] <= 1e-7 * V[0]).all()
    assert V[-1] < 0.98 * V[0]


@pytest.mark.parametrize(("wrong", "seconds"), [(0, 0.5), (1, 0.1), (2, 0.5)])
def test_v_grows_where_an_estimate_moves_the_wrong_way(wrong, seconds):
    psi = list(PSI)
    psi[wrong] = -psi[wrong]
    V, s = lyapunov(law_of(psi), lambda _: 0.0, seconds=seconds)
    outside = np.minimum(np.abs(s[1:]), np.abs(s[:-1])) > SURFACE.width
    assert np.diff(V)[outside].max() > 1e-5 * V[0]


def test_v_grows_where_the_disturbance_exceeds_epsilon():
    V, _ = lyapunov(law_of(epsilon=0.1), lambda _: -5.0)
    assert np.diff(V).max() > 1e-5 * V[0]
