"""The error's filter against a Butterworth filter of scipy."""

import math

import numpy as np
import pytest
from scipy.signal import butter, cont2discrete, tf2ss

from tsas_cli.controllers.signals import error_filter, filtered


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
