"""Intervals under coloured noise: the stated rate must be the rate."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tsas_cli.numerics.covariance import block_length, inverse_gram, jackknife, memory


def coloured(rng, n, rho):
    return lfilter([np.sqrt(1.0 - rho**2)], [1.0, -rho], rng.normal(size=n + 500))[500:]


@pytest.mark.parametrize("rho", [0.0, 0.9, 0.98])
def test_memory_of_a_first_order_process(rho):
    """Its autocorrelation sums to (1 + ρ)/(1 − ρ)."""
    found = [memory(coloured(np.random.default_rng(s), 20_000, rho)) for s in range(20)]
    assert np.median(found) == pytest.approx((1.0 + rho) / (1.0 - rho), rel=0.15)


@pytest.mark.parametrize("rho", [0.0, 0.9, 0.98])
def test_the_interval_of_a_slope_holds_at_its_rate(rho):
    """The plain formula, which counts samples, covers a third of the time at ρ = 0.98."""
    n = 2500
    J = np.column_stack((np.ones(n), np.linspace(-1.0, 1.0, n)))
    held = plain = 0
    for seed in range(300):
        residual = coloured(np.random.default_rng(seed), n, rho)
        found, *_ = np.linalg.lstsq(J, residual, rcond=None)
        left = residual - J @ found
        covariance, t = jackknife(J, left, np.arange(n) // block_length([left]))
        held += abs(found[1]) < t[1] * np.sqrt(covariance[1, 1])
        plain += abs(found[1]) < 1.96 * left.std() / np.sqrt(np.sum(J[:, 1] ** 2))
    assert 0.89 < held / 300 < 0.985
    if rho > 0.9:
        assert plain / 300 < 0.5


def test_blocks_are_longer_than_the_memory_and_not_too_few():
    rng = np.random.default_rng(1)
    assert block_length([rng.normal(size=4000)]) < 10
    assert block_length([coloured(rng, 4000, 0.98)]) > 100
    assert block_length([np.linspace(-1.0, 1.0, 4000)]) == 500


def test_one_wild_block_widens_the_interval():
    J = np.ones((100, 1))
    calm = np.tile([0.1, -0.1], 50)
    wild = calm.copy()
    wild[:10] += 1.0
    wild -= wild.mean()
    block = np.arange(100) // 10
    assert jackknife(J, wild, block)[0][0, 0] > 50.0 * jackknife(J, calm + 1e-3, block)[0][0, 0]


def test_what_shows_only_together_leaves_the_intervals_of_others_alone():
    """Two columns that are alike but for the errors of finite differences."""
    rng = np.random.default_rng(4)
    J, residual, block = rng.normal(size=(400, 3)), rng.normal(size=400), np.arange(400) // 10
    alike = J[:, 2] + 1e-6 * rng.normal(size=400)
    alone, both = (jackknife(K, residual, block)[0] for K in (J, np.column_stack((J, alike))))
    assert np.diag(both)[:2] == pytest.approx(np.diag(alone)[:2], rel=1e-3)


def test_the_inverse_is_that_of_the_normal_equations_in_any_units():
    J = np.random.default_rng(5).normal(size=(50, 3)) * [1e-6, 1.0, 1e6]
    product = inverse_gram(J) @ (J.T @ J)
    assert np.diag(product) == pytest.approx(np.ones(3))
    none = np.column_stack((J[:, 1], np.zeros(50)))
    assert inverse_gram(none) == pytest.approx(np.diag([1.0 / (J[:, 1] @ J[:, 1]), 0.0]))
