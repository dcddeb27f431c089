"""Bounded least squares, held against scipy's and against what is known."""

import numpy as np
import pytest
from scipy.optimize import least_squares as reference

from tsas_cli.numerics.least_squares import least_squares

T = np.linspace(0.0, 4.0, 200)
FREE = (np.full(3, -np.inf), np.full(3, np.inf))


def decay(p):
    """A decaying wave: amplitude, rate, frequency."""
    return p[0] * np.exp(-p[1] * T) * np.cos(p[2] * T)


def slopes(p):
    wave, fade = np.cos(p[2] * T), np.exp(-p[1] * T)
    return np.array([fade * wave, -T * p[0] * fade * wave, -T * p[0] * fade * np.sin(p[2] * T)]).T


TRUTH = np.array([2.0, 0.5, 3.0])


def fitted(start, bounds=FREE, *, noise=0.0, jacobian=slopes, tolerance=1e-12, most=100, **known):
    data = decay(TRUTH) + noise * np.random.default_rng(1).standard_normal(T.size)
    how = {"tolerance": tolerance, "most": most} | known
    return least_squares(lambda p: decay(p) - data, jacobian, np.array(start), bounds, **how), data


def test_the_truth_is_found():
    found, _ = fitted([1.0, 0.1, 2.5])
    assert found.converged
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-6)
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-6)


@pytest.mark.parametrize("upper_rate", [np.inf, 0.3])
def test_it_is_scipys_minimum_with_and_without_a_bound_that_holds(upper_rate):
    bounds = (np.full(3, -10.0), np.array([10.0, upper_rate, 10.0]))
    found, data = fitted([1.0, 0.1, 2.5], bounds, noise=0.1)
    known = reference(lambda p: decay(p) - data, [1.0, 0.1, 2.5], slopes, bounds, xtol=1e-14)
    np.testing.assert_allclose(found.values, known.x, rtol=1e-4)
    assert found.values[1] <= upper_rate
    np.testing.assert_allclose(found.jacobian, slopes(found.values))


def test_slopes_that_are_nearly_known_lead_to_the_same_minimum_by_fewer_jacobians():
    asked = []

    def counted(p):
        asked.append(p)
        return slopes(p)

    how = {"jacobian": counted, "tolerance": 1e-9, "slopes": slopes([1.7, 0.6, 2.8])}
    found, _ = fitted([1.9, 0.45, 2.95], **how)
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-6)
    np.testing.assert_allclose(found.jacobian, slopes(found.values), atol=1e-3)
    with_all = len(asked)
    assert with_all < found.evaluations
    asked.clear()
    rough, _ = fitted([1.9, 0.45, 2.95], values_only=True, **how)
    np.testing.assert_allclose(rough.values, TRUTH, rtol=1e-4)
    assert len(asked) < with_all


def test_slopes_that_are_known_wrongly_are_calculated_where_no_step_helps():
    start = [1.0, 0.1, 2.5]
    found, _ = fitted(start, tolerance=1e-9, slopes=-slopes(start))
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-6)


def test_a_step_to_where_nothing_is_finite_is_none_and_corrects_no_slopes():
    """As where a model cannot be simulated; the slopes known lead far off, at first."""

    seen = []

    def residual(p):
        seen.append(tuple(p))
        return decay(p) - decay(TRUTH) if p[1] < 0.6 else np.full(T.size, np.nan)

    start = np.array([1.8, 0.4, 2.9])
    known = slopes(start) * [1.0, 0.01, 1.0]
    how = {"tolerance": 1e-12, "most": 100, "slopes": known}
    found = least_squares(residual, slopes, start, FREE, **how)
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-6)
    assert seen[1][1] > 0.6
    assert len(set(seen)) == len(seen)  # none is tried twice


def test_a_start_outside_of_the_bounds_is_moved_inside():
    bounds = (np.zeros(3), np.array([5.0, 1.0, 4.0]))
    found, _ = fitted([9.0, -1.0, 2.9], bounds)
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-6)


def test_an_unknown_that_does_nothing_stays_where_it_is():
    def two(p):
        return np.array([p[0] - 3.0, 2.0 * (p[0] - 3.0)])

    def jacobian(p):
        return np.array([[1.0, 0.0], [2.0, 0.0]])

    found = least_squares(
        two, jacobian, np.array([0.0, 7.0]), (np.full(2, -9.0), np.full(2, 9.0)),
        tolerance=1e-12, most=50,
    )  # fmt: skip
    np.testing.assert_allclose(found.values, [3.0, 7.0])


def test_giving_up_is_said():
    found, _ = fitted([1.0, 0.1, 2.5], most=2)
    assert not found.converged
    assert "2 evaluations" in found.message
