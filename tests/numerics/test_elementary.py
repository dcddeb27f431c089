"""Exponential and logarithm of the kernels, against those of the library."""

import math

import numpy as np
import pytest

from tsas_cli.numerics.elementary import LARGEST, exponential, logarithm


def test_the_exponential():
    for x in [*np.linspace(-LARGEST, LARGEST, 1999).tolist(), 1e-300, -1e-12]:
        assert math.isclose(exponential(x), math.exp(x), rel_tol=1e-12), x


def test_the_exponential_of_nothing_is_one_and_ends_do_not_run_away():
    assert exponential(0.0) == 1.0
    assert exponential(-1e9) == pytest.approx(math.exp(-LARGEST))
    assert exponential(1e9) == pytest.approx(math.exp(LARGEST))
    assert math.isnan(exponential(math.nan))


def test_the_logarithm():
    for x in [*np.geomspace(1e-30, 1e30, 1999).tolist(), 1.0, 2.0, math.e]:
        assert math.isclose(logarithm(x), math.log(x), rel_tol=1e-13, abs_tol=1e-13), x
