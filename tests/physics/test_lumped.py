"""The lumped tendon: its values of a rig, and both points with friction held at every sample."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.lumped import HELD, Lumped, follow, lumped_of
from tsas_cli.physics.rig import with_values

SPRINGS = Lumped(25.0, 40.0, 60.0, 5.0, 2.0, 1.5, 6.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
WAYS = np.array([0.0, 0.1, 0.6, 1.5, 1.4, 0.9, 0.2, 0.1, -0.5, -0.9, -0.8, -0.2, 0.4, 0.5])
NAMES = (
    *("sheath_compression.compliance_ratio", "free_tendon.proximal_length_mm"),
    *("free_tendon.distal_length_mm", "drive_compliance.compliance_mm_per_N"),
    *("proximal_spring.stiffness_N_per_mm", "drive_friction.friction_N"),
    *("load_friction.before_sensor_N", "load_friction.after_sensor_N"),
    *("drive_damping.coefficient_N_s_per_mm", "viscous_friction.coefficient_N_s_per_mm"),
    *("load_damping.coefficient_N_s_per_mm", "drive_inertia.mass_kg", "load_inertia.mass_kg"),
    "sheath_drag.force_N",
)
VALUES = dict(zip(NAMES, (0.3, 40, 15, 0.004, 3, 1.5, 1, 0.7, 0.2, 0.3, 0.4, 5, 6, 2), strict=True))


def test_half_of_the_tendon_lies_on_either_side_of_its_friction():
    EA, L, kL = GROUP_A[1], GROUP_A.sheath_length_mm, GROUP_A.load_stiffness_N_per_mm
    before, behind = 0.65 * L / EA + 40.0 / EA + 0.004, 0.65 * L / EA + 15.0 / EA
    pulled = 25.0 + 0.5 * 10.0 / (before + behind + 1.0 / kL)  # half of the stroke
    loss = 2.0 + pulled * (math.exp(math.pi / 16.0) - math.exp(-math.pi / 16.0))
    expected = 25.0, 1.0 / before, 1.0 / behind, kL, 3.0, 1.5, loss, 1.7, 0.2, 0.3, 0.4, 5.0, 6.0
    assert lumped_of(with_values(GROUP_A, VALUES), 10.0) == pytest.approx(expected)
    assert set(HELD) == {name.split(".")[0] for name in VALUES}


@pytest.mark.parametrize("smooth", [{}, {"sheath_friction_N": 0.0}, {"load_friction_N": 0.0}])
def test_each_point_balances_and_rests_until_the_springs_exceed_its_friction(smooth):
    lumped, turned = SPRINGS._replace(**smooth), np.repeat([1.0, -1.0, 1.0], [4, 6, 4])
    f_in, x_out = follow(lumped, WAYS)
    pulls = f_in - 2.0 * WAYS - 1.5 * turned  # less what is beside the tendon
    there = WAYS - (pulls - 25.0) / 40.0
    passed = 60.0 * (there - x_out)
    assert pulls.min() > 0.0
    for force, place, limit in (
        (pulls - 25.0 - passed, there, lumped.sheath_friction_N),
        (passed - 5.0 * x_out, x_out, lumped.load_friction_N),
    ):
        ways = np.diff(place, prepend=0.0)
        moved = np.abs(ways) > 1e-10
        np.testing.assert_allclose(force[moved], limit * np.sign(ways[moved]), atol=1e-9)
        assert np.abs(force).max() < limit + 1e-9
        assert {-1.0, 1.0} == set(np.sign(ways[moved]))


def test_a_tendon_that_is_pushed_holds_nothing():
    f_in, _ = follow(SPRINGS._replace(beside_N_per_mm=0.0, drive_friction_N=0.0), -5.0 * WAYS**2)
    assert (f_in[0], f_in.min()) == (25.0, 0.0)
