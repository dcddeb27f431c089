"""Each controller's law against a plain formula; every argument has a value of its own."""

import math

import numpy as np
import pytest
from scipy.signal import butter, cont2discrete, tf2ss

from tsas_cli.controllers import CONTROLLERS
from tsas_cli.controllers.adaptive_sliding_mode import AdaptiveSlidingMode, adaptive_sliding_mode
from tsas_cli.controllers.laws import MEMORY, ControllerSettings, control
from tsas_cli.controllers.pid import Pid, pid
from tsas_cli.controllers.signals import Signals, error_filter, filtered
from tsas_cli.controllers.sliding_mode import Phi, Surface, distance, reaching, sliding_mode

SEEN = Signals(
    e=0.3, e_filtered=0.25, de=-1.7, dde=11.0, v=6.0, a=-23.0, jerk=70.0, applied=9.0, limited=False
)
SURFACE = Surface(c1=8.0, c2=1.5, epsilon=4.0, ks=0.6, width=100.0)
PHI = Phi(0.005, 18.0, 0.02)
S = 8.0 * 0.25 + 1.5 * -1.7 + 11.0
JERK = 8.0 * -1.7 + 1.5 * 11.0 + 70.0
ALONG = 0.005 * JERK + 18.0 * (6.0 + 1.7) + 0.02 * (-23.0 - 11.0)


@pytest.mark.parametrize(("limited", "total"), [(False, 0.5 + 0.3 * 0.1), (True, 0.5)])
def test_pid_adds_its_three_parts_and_holds_its_sum_at_the_motor_s_limit(limited, total):
    memory = np.array([0.5, 0.0, 0.0])
    u = pid(SEEN._replace(limited=limited), Pid(25.0, 65.0, 2.0), memory, 0.1)
    assert memory[0] == pytest.approx(total)
    assert u == pytest.approx(25.0 * 0.3 + 65.0 * total + 2.0 * -1.7)


@pytest.mark.parametrize(
    ("s", "expected"),
    [(0.0, 0.0), (50.0, 0.5 * 4.0 + 30.0), (300.0, 4.0 + 180.0)],
)
def test_reaching_is_straight_within_the_boundary_layer(s, expected):
    assert reaching(s, SURFACE) == pytest.approx(expected)
    assert reaching(-s, SURFACE) == pytest.approx(-expected)


def test_sliding_mode_is_equation_45():
    """Its surface is equation 41."""
    assert distance(SEEN, SURFACE) == pytest.approx(S)
    expected = ALONG + 4.0 * S / 100.0 + 0.6 * S
    assert sliding_mode(SEEN, SURFACE, PHI) == pytest.approx(expected)


WIDE = AdaptiveSlidingMode(
    SURFACE, PHI, Phi(-1e9, -1e9, -1e9), Phi(1e9, 1e9, 1e9), psi=Phi(0.3, 0.5, 0.7)
)


def test_adaptive_sliding_mode_uses_its_estimates_and_renews_them():
    memory = np.array([0.01, 21.0, 0.04])
    u = adaptive_sliding_mode(SEEN, WIDE, memory, 0.1)
    along = 0.01 * JERK + 21.0 * (6.0 + 1.7) + 0.04 * (-23.0 - 11.0)
    assert u == pytest.approx(along + 4.0 * S / 100.0 + 0.6 * S)
    assert memory == pytest.approx(
        (
            0.01 + 0.1 * 0.3 * S * JERK,
            21.0 + 0.1 * 0.5 * S * (6.0 + 1.7),
            0.04 + 0.1 * 0.7 * S * (-23.0 - 11.0),
        )
    )


def test_every_estimate_stops_at_its_own_bounds():
    lowest, highest = Phi(0.001, 17.0, 0.01), Phi(0.006, 19.0, 0.03)
    bounded = WIDE._replace(lowest=lowest, highest=highest)
    memory = np.array(PHI)
    adaptive_sliding_mode(SEEN, bounded, memory, 10.0)
    assert memory == pytest.approx((0.006, 19.0, 0.01))
    memory = np.array(PHI)
    adaptive_sliding_mode(SEEN, bounded._replace(psi=Phi(-0.3, -0.5, -0.7)), memory, 10.0)
    assert memory == pytest.approx((0.001, 17.0, 0.03))


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_a_controller_keeps_no_more_than_the_memory_holds(controller):
    """A kernel would write behind it, and nobody would notice."""
    kept = ControllerSettings().of(controller).COLUMNS
    assert len(kept) <= MEMORY, f"{kept}: MEMORY of controllers/laws.py holds {MEMORY}"


def test_a_controller_without_a_call_is_no_other_one():
    laws = ControllerSettings().laws("pid", 0.02)._replace(kind=len(CONTROLLERS))
    with pytest.raises(ValueError, match=r"without its call in controllers/laws\.py"):
        control(SEEN, laws, np.zeros(MEMORY), 0.1)


def run(errors, cutoff_Hz, step_s):
    """Return the filter's states after each sample, shape (m, 3)."""
    A, b = error_filter(cutoff_Hz, step_s)
    state, rows = np.zeros(3), []
    for e in errors:
        filtered(state, float(e), A, b)
        rows.append(state.copy())
    return np.array(rows)


@pytest.mark.parametrize(("cutoff_Hz", "step_s"), [(10.0, 1e-3), (3.0, 0.02), (50.0, 5e-4)])
def test_it_is_butterworth_of_third_order_for_an_error_that_is_held(cutoff_Hz, step_s):
    numerator, denominator = butter(3, 2.0 * math.pi * cutoff_Hz, analog=True)
    A, B, C, D = tf2ss(numerator, denominator)
    rows = np.vstack([(C @ np.linalg.matrix_power(A, k)).ravel() for k in range(3)])  # e, ė, ë
    Ad, Bd, Cd, _, _ = cont2discrete((A, B, rows, np.zeros((3, 1))), step_s, method="zoh")
    assert D == 0.0
    errors = np.random.default_rng(5).standard_normal(300)
    state, expected = np.zeros((3, 1)), []
    for e in errors:
        state = Ad @ state + Bd * e
        expected.append((Cd @ state).ravel())
    expected = np.array(expected)
    got = run(errors, cutoff_Hz, step_s)
    for ours, theirs in zip(got.T, expected.T, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-8 * np.abs(theirs).max())
