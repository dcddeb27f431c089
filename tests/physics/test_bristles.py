"""Mass and damping of the bristles."""

import math

import pytest

from tsas_cli.physics.bristles import Bristles, bristle_damping, tendon_mass


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
