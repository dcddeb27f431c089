"""Exponential and logarithm of the kernels, against those of the library."""

import math

import numpy as np
import pytest

from tsas_cli.numerics.elementary import LARGEST, exponential, logarithm


@pytest.mark.parametrize("x", [*np.linspace(-LARGEST, LARGEST, 1999).tolist(), 1e-300, -1e-12])
def test_the_exponential(x):
    assert exponential(x) == pytest.approx(math.exp(x), rel=1e-12)


def test_the_exponential_of_nothing_is_one_and_ends_do_not_run_away():
    assert exponential(0.0) == 1.0
    assert exponential(-1e9) == pytest.approx(math.exp(-LARGEST))
    assert exponential(1e9) == pytest.approx(math.exp(LARGEST))
    assert math.isnan(exponential(math.nan))


@pytest.mark.parametrize("x", [*np.geomspace(1e-30, 1e30, 1999).tolist(), 1.0, 2.0, math.e])
def test_the_logarithm(x):
    assert logarithm(x) == pytest.approx(math.log(x), rel=1e-13, abs=1e-13)
