"""Compliances in series, an uneven bend, mass and damping of the bristles."""

import math

import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.bristles import Bristles, bristle_damping, tendon_mass
from tsas_cli.physics.compliances import (
    compliance_at_drive,
    compliance_at_load,
    length_per_angle,
    sheath_compliance,
)
from tsas_cli.physics.rig import with_values

EA, F0 = GROUP_A.tendon_stiffness_N, GROUP_A.preload_N


def test_compliances_in_series():
    rig = with_values(
        GROUP_A,
        {
            "free_tendon.proximal_length_mm": 120.0,
            "free_tendon.distal_length_mm": 30.0,
            "drive_compliance.compliance_mm_per_N": 0.004,
            "sheath_compression.compliance_ratio": 0.5,
        },
    )
    assert compliance_at_drive(rig) == pytest.approx(120.0 / EA + 0.004)
    assert compliance_at_load(rig) == pytest.approx(30.0 / EA)
    assert sheath_compliance(rig) == pytest.approx(1.5 * rig.sheath_length_mm / EA)


@pytest.mark.parametrize(("slope", "bow"), [(0.3, 0.0), (0.0, 0.4), (-0.2, 0.1)])
def test_an_uneven_bend_leaves_the_whole_length_as_it_is(slope, bow):
    """Legendre's polynomials: ends by hand, and a mean of 1 by Simpson's rule."""
    rig = GROUP_A._replace(bend_slope=slope, bend_bow=bow)
    start, middle, end = (length_per_angle(place, rig) for place in (-1.0, 0.0, 1.0))
    assert (start, end) == pytest.approx((1.0 - slope + bow, 1.0 + slope + bow))
    assert (start + 4.0 * middle + end) / 6.0 == pytest.approx(1.0)


def test_mass_and_critical_damping_of_the_bristles():
    """2.5 g/m over 800 mm are 2 g; 2 √(k m), k the bristles in series with Dahl's travel."""
    assert tendon_mass(Bristles(), 800.0) == pytest.approx(2e-6)
    told = Bristles(damping_N_s_per_mm=3.0)
    assert bristle_damping(told, 800.0, 10.0, 0.01) == 3.0
    k = 1.0 / (1.0 / 5000.0 + 0.01 / 10.0)
    assert bristle_damping(Bristles(), 800.0, 10.0, 0.01) == pytest.approx(
        2.0 * math.sqrt(k * 2e-6)
    )
    straight = bristle_damping(Bristles(), 800.0, 0.0, 0.01)
    assert straight == pytest.approx(2.0 * math.sqrt(5000.0 * 2e-6))
