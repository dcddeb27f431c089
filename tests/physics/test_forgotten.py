"""From where on a run does not depend on what came before it."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import first_determined_sample, simulate

RIG = GROUP_A
EA, KL, L, _, F0 = GROUP_A[1:6]
WRAP = wrap_of(GROUP_A)


def dead_band(x):
    """Return the travel from contraction at x to loosening, by the formulas of Yang 2025."""
    slope = KL * math.exp(WRAP) / (1.0 + KL * (math.exp(WRAP) - 1.0) * L / (WRAP * EA))
    tension = slope * (x + F0 * (1.0 / KL + L / EA))
    return L / (WRAP * EA) * tension * (1.0 - math.exp(-WRAP)) ** 2


def test_a_release_forgets_when_the_widest_dead_band_is_crossed():
    x = 10.0 - np.arange(0.0, 1.0, 1e-3)
    first = first_determined_sample(RIG, DriveInput(x))
    assert x[0] - x[first] == pytest.approx(dead_band(10.0), abs=1.5e-3)


def test_a_move_inside_the_dead_band_is_never_forgotten():
    x = 10.0 + 0.4 * dead_band(10.0) * np.sin(np.linspace(0.0, 20.0, 500))
    assert first_determined_sample(RIG, DriveInput(x)) is None
    assert first_determined_sample(RIG, DriveInput(np.full(100, 10.0))) is None


@pytest.mark.parametrize("wanted", [5.0, 200.0])
def test_a_tension_out_of_reach_starts_at_the_nearest_one(wanted):
    """Below that of loosening, or above that of contraction."""
    x = np.full(3, 10.0)
    reached = simulate(RIG, DriveInput(x, start_f_in_N=wanted)).f_in_N[0]
    pulled = simulate(RIG, DriveInput(np.array([0.0, 10.0]))).f_in_N[-1]
    released = simulate(RIG, DriveInput(np.array([0.0, 20.0, 10.0]))).f_in_N[-1]
    assert reached == pytest.approx(pulled if wanted > 100.0 else released, rel=1e-6)
