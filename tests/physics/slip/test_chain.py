"""The slip chain against the closed form and against a profile on a fine grid."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import (
    FREE,
    GROUP_A,
    branches,
    follow,
    through,
)


@pytest.mark.parametrize(
    ("motion", "rms_order"),
    [
        pytest.param(np.linspace(20.0, 19.75, 50001), 1.8, id="constant speed"),
        pytest.param(10.0 + 10.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 40001)), 1.45, id="sine"),
    ],
)
def test_order_of_the_mesh(motion, rms_order):
    """At reversals, where the exact slope is infinite, it is first; a sine lingers there."""
    exact = branches(motion, GROUP_A)[0]
    errors = [follow(motion, n=n)[2] - exact for n in (10, 20, 40, 80, 160)]
    rms = [math.sqrt(np.mean(e**2)) for e in errors]
    largest = [np.abs(e).max() for e in errors]
    assert math.log2(rms[0] / rms[-1]) / 4.0 > rms_order
    assert 0.95 < math.log2(largest[0] / largest[-1]) / 4.0 < 1.1


def test_full_slip_is_second_order():
    exact = branches(np.array([20.0]), GROUP_A)[0][0]
    errors = [abs(follow([20.0], n=n)[2][0] - exact) for n in (10, 20, 40, 80, 160)]
    assert errors[0] < 1e-3
    for coarse, fine in pairwise(errors):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.05)


def test_one_large_step_is_many_small_ones():
    turns = np.array([14.0, 13.93, 13.96, 13.2, 13.3, -5.0, 13.0])
    fine = follow(through(*turns, samples=1000), rig=FREE)
    for coarse, small in zip(follow(turns, rig=FREE), fine, strict=True):
        np.testing.assert_allclose(coarse, small[999::1000], rtol=1e-7)
