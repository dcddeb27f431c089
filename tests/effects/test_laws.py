"""Laws at one point, where no run of the model shows them: slopes, limits, what yields."""

import numpy as np
import pytest

from tsas_cli.effects.bend_drift import BendDrift, drifted_bend
from tsas_cli.effects.friction_drift import FrictionDrift, friction_factor
from tsas_cli.effects.load_hysteresis import LoadHysteresis, element_force
from tsas_cli.effects.presliding import friction_share, friction_share_rate
from tsas_cli.numerics.wave import Wave, wave_at


@pytest.mark.parametrize("way", [0.003, 0.02, 0.1, -0.003, -0.02, -0.1])
@pytest.mark.parametrize("before", [-1.0, -0.2, 0.0, 0.7, 1.0])
def test_friction_turns_round_by_dahls_law(before, way):
    """dz/dx = (1 − z sgn(dx))/length, integrated in small steps."""
    length, z = 0.02, before
    for step in np.full(20_000, way / 20_000):
        z += step * (1.0 - z * np.sign(step)) / length
    assert friction_share(before, way, length) == pytest.approx(z, abs=1e-3)
    slope = (
        friction_share(before, way + 1e-7, length) - friction_share(before, way, length)
    ) / 1e-7
    share = friction_share(before, way, length)
    assert friction_share_rate(share, way, length) == pytest.approx(slope, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("before", [-1.0, -0.2, 0.7])
def test_before_any_way_the_steeper_side_counts(before):
    sides = [friction_share_rate(before, way, 0.02) for way in (1e-12, -1e-12)]
    assert friction_share_rate(before, 0.0, 0.02) == pytest.approx(max(sides))


@pytest.mark.parametrize("position", [-3.0, 0.0, 0.4])
def test_a_wave_has_its_period_its_slope_and_is_nothing_at_rest(position):
    ripple = Wave(sine_mm=0.3, cosine_mm=-0.2, period_mm=7.0)
    ahead, behind = (wave_at(position + step, ripple)[0] for step in (1e-4, -1e-4))
    wave, slope = wave_at(position, ripple)
    assert slope == pytest.approx((ahead - behind) / 2e-4, rel=1e-6)
    assert wave_at(position + 7.0, ripple)[0] == pytest.approx(wave)
    assert wave_at(0.0, ripple)[0] == 0.0
    assert wave_at(1.75, ripple)[0] == pytest.approx(0.3 + 0.2)


def test_an_element_follows_by_its_stiffness_and_yields():
    law = LoadHysteresis(force_N=2.0, travel_mm=0.5)
    assert element_force(0.0, 0.25, law) == (1.0, 4.0)
    assert element_force(1.5, 0.25, law) == (2.0, 0.0)
    assert element_force(2.0, -0.75, law) == (-1.0, 4.0)
    assert element_force(2.0, -9.0, law) == (-2.0, 0.0)


def test_a_drift_never_turns_bend_or_friction_the_other_way():
    assert drifted_bend(3.0, BendDrift(-1.0, 0.0), 20.0) == 0.0
    drift = FrictionDrift(rate_per_s=-1.0, settling_per_s=0.0, session_rate_per_s=0.0005)
    assert friction_factor(drift, 20.0, 0.0) == 0.0
    both = drift._replace(rate_per_s=0.002)
    assert friction_factor(both, 20.0, 100.0) == pytest.approx(1.04 + 0.05)
