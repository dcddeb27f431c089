"""The observer on the integrator that it assumes, against linear theory."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tsas_cli.controllers.disturbance_observer import DisturbanceObserver, disturbance_observer
from tsas_cli.controllers.signals import Signals

K, W, C = 0.0236, 40.0, 10.0
LAW = DisturbanceObserver(C, W, K)


def seen(e, applied):
    return Signals(e, *np.zeros(6), applied, False)


def run(step_s, *, law=LAW, seconds=0.6, disturbance=120.0, start=0.0, closed=True):
    """Return time, error, its estimate and that of the disturbance; dx/dt = K (u + d), x_inv = 0.

    An open loop hears what it wants and gets a sine instead.
    """
    memory, e, applied, rows = np.zeros(3), start, 0.0, []
    memory[0] = start
    for k in range(round(seconds / step_s)):
        u = disturbance_observer(seen(e, applied), law, memory, step_s)
        rows.append((k * step_s, e, memory[0], memory[1]))
        applied = u if closed else 300.0 * math.sin(20.0 * k * step_s)
        e -= step_s * K * (applied + disturbance)
    return np.array(rows).T


def test_a_constant_disturbance_is_learned_and_its_error_goes():
    _, e, e_seen, d = run(1e-3, seconds=2.0)
    assert d[-1] == pytest.approx(120.0, rel=1e-6)
    assert (e[-1], e_seen[-1]) == pytest.approx((0.0, 0.0), abs=1e-7)
    assert np.abs(e).max() > 0.03


@pytest.mark.parametrize("closed", [True, False])
def test_both_poles_of_the_observer_are_at_its_bandwidth(closed):
    """d − d̂ = d (1 + ω t) e^(−ω t), whatever is asked for; in first order of the step."""
    errors = []
    for step_s in (4e-4, 2e-4, 1e-4):
        t, _, _, d = run(step_s, closed=closed)
        expected = 120.0 * (1.0 - (1.0 + W * t) * np.exp(-W * t))
        errors.append(np.abs(d - expected).max())
    assert errors[-1] < 0.02 * 120.0
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(2.0, abs=0.35)


@pytest.mark.parametrize(("loop", "observer", "seen"), [(C, W, 0.3), (5.0, 90.0, math.inf)])
def test_an_error_alone_goes_with_the_bandwidth_of_the_loop(loop, observer, seen):
    law = DisturbanceObserver(loop, observer, K)
    t, e, _, d = run(1e-4, law=law, disturbance=0.0, start=0.5)
    np.testing.assert_allclose(e, 0.5 * np.exp(-loop * t), atol=2e-3)
    assert np.abs(d).max() < seen
