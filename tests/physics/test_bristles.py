"""Constants of the bristles, and their friction."""

import math

import pytest

from tsas_cli.physics.bristles import (
    Bristle,
    Bristles,
    bristle_damping,
    friction,
    friction_now,
    tendon_mass,
)


def test_mass_and_critical_damping_of_the_bristles():
    """2.5 g/m over 800 mm are 2 g; 2 √(k m), k the bristles in series with Dahl's travel."""
    assert tendon_mass(Bristles(), 800.0) == pytest.approx(2e-6)
    told = Bristles(damping_N_s_per_mm=3.0)
    assert bristle_damping(told, 800.0, 10.0, 0.01) == 3.0
    k, small = (1.0 / (1.0 / 5000.0 + 0.01 / limit_N) for limit_N in (10.0, 0.5))
    straight = 5000.0  # of a straight sheath there is no limit
    for limit_N, stiffness in ((10.0, k), (0.5, small), (0.0, straight)):
        critical = 2.0 * math.sqrt(stiffness * 2e-6)
        assert bristle_damping(Bristles(), 800.0, limit_N, 0.01) == pytest.approx(critical)


def test_usual_constants_are_those_of_table_1_for_the_whole_sheath():
    """Yang 2025: 100 N/mm for each of 50 lumps, 0.25 kg for 100 m, 0.1 N s/mm for each of 50."""
    critical = math.nan  # the paper's damping diverges
    table_1 = 100.0 * 50, critical, 0.25 / 100.0, 0.1 / 50
    assert Bristles() == pytest.approx(table_1, nan_ok=True)


@pytest.mark.parametrize("speed", [0.7, -0.7])
def test_friction_now_is_that_of_a_step_of_no_time(speed):
    bristle = Bristle(300.0, 0.5, 0.02, 0.01)
    now, rate_now = friction_now(0.004, speed, 2.0, bristle)
    later, _, _, z = friction(0.004, speed, 1e-9, 2.0, bristle)
    assert now == pytest.approx(later, rel=1e-5)
    assert rate_now == pytest.approx((z - 0.004) / 1e-9, rel=1e-5)
    longest = 2.0 / 300.0 + 0.01
    assert rate_now == pytest.approx(speed * (1.0 - math.copysign(1.0, speed) * 0.004 / longest))
