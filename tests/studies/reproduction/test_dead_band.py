"""The dead band of the distributed model against its closed form, and against a profile."""

import math

import numpy as np
import pytest

from tests.physics.references import Profile
from tsas_cli.effects import Effects, FreeTendon
from tsas_cli.paper import yang2025
from tsas_studies.reproduction.dead_band import dead_band
from tsas_studies.reproduction.rig import bench_rig

RIG = bench_rig(yang2025())
A = math.pi / 8.0
SECANT = RIG.tendon_stiffness_N * A / (785.0 * math.tanh(A / 2.0))
UP, DOWN = dead_band(RIG, 20.0, up=True), dead_band(RIG, 20.0, up=False)


def test_the_secant_is_that_of_the_lumped_model():
    assert abs(SECANT - 175.10) < 5e-3
    assert UP.secant == pytest.approx(SECANT, rel=1e-6)
    assert DOWN.secant == pytest.approx(SECANT, rel=1e-6)


def test_the_last_tangents():
    assert UP.last_tangent == pytest.approx(104.5, abs=0.1)
    assert DOWN.last_tangent == pytest.approx(70.6, abs=0.1)


def test_a_line_through_evenly_spaced_points_is_biased():
    """T = A (1 ± c √u)² over u from 0 to 1: the line's slope is that of 2c·0.8 √u and c² u."""
    up, down = math.exp(A) - 1.0, 1.0 - math.exp(-A)
    assert UP.slope() == pytest.approx(SECANT * (1.6 + up) / (2.0 + up), rel=1e-3)
    assert DOWN.slope() == pytest.approx(SECANT * (1.6 - down) / (2.0 - down), rel=1e-3)
    assert UP.slope() == pytest.approx(147.1, rel=3e-3)
    assert DOWN.slope() == pytest.approx(133.6, rel=3e-3)


@pytest.mark.parametrize("up", [True, False])
def test_the_curve_is_that_of_a_profile_of_tensions(up):
    band = UP if up else DOWN
    profile = Profile(RIG)
    profile.pull_drive_to(100.0)
    if up:
        profile.pull_drive_to(20.0)
    start, begin, travel = profile.tension[0], profile.x_in, []
    tensions = np.linspace(start, start * math.exp(2.0 * A if up else -2.0 * A), 41)
    for tension in tensions:
        profile.pull_drive_to(tension)
        travel.append(abs(profile.x_in - begin))
    scale = start / band.f_in_N[0]  # a band scales with its tension
    curve = np.interp(travel, scale * np.abs(band.x_mm), scale * band.f_in_N)
    assert curve[1:] == pytest.approx(tensions[1:], rel=2e-3)


def test_parts_of_the_band_are_steeper():
    share = DOWN.share_with_slope(220.63)
    assert DOWN.slope(share) == pytest.approx(220.63, rel=1e-2)
    assert 0.1 < share < 0.9
    assert UP.share_with_slope(101.96) is None


def test_free_tendon_widens_the_band_and_lowers_its_slope():
    free = RIG._replace(effects=Effects(free_tendon=FreeTendon(278.0, 0.0)))
    band = dead_band(free, 20.0, up=False)
    assert band.secant == pytest.approx(101.96, abs=0.05)
    assert band.slope() < DOWN.slope()
    assert band.width_mm > DOWN.width_mm
