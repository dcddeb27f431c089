"""The lumped tendon: its values of a rig, and both points with friction held at every sample."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.lumped import HELD, Lumped, follow, lumped_of
from tsas_cli.physics.rig import with_values

SPRINGS = Lumped(25.0, 40.0, 60.0, 5.0, 2.0, 1.5, 6.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
WAYS = np.array([0.0, 0.1, 0.6, 1.5, 1.5, 1.4, 0.9, 0.2, 0.3, -1.0, -4.0, -3.9, -2.0, 0.4])
VALUES = {
    "sheath_compression.compliance_ratio": 0.3,
    "free_tendon.proximal_length_mm": 40.0,
    "free_tendon.distal_length_mm": 15.0,
    "drive_compliance.compliance_mm_per_N": 0.004,
    "proximal_spring.stiffness_N_per_mm": 3.0,
    "drive_friction.friction_N": 1.5,
    "load_friction.before_sensor_N": 1.0,
    "load_friction.after_sensor_N": 0.7,
    "drive_damping.coefficient_N_s_per_mm": 0.2,
    "viscous_friction.coefficient_N_s_per_mm": 0.3,
    "load_damping.coefficient_N_s_per_mm": 0.4,
    "drive_inertia.mass_kg": 5.0,
    "load_inertia.mass_kg": 6.0,
}


def test_half_of_the_tendon_lies_on_either_side_of_its_friction():
    EA, L, kL = GROUP_A[1], GROUP_A.sheath_length_mm, GROUP_A.load_stiffness_N_per_mm
    before, behind = 0.65 * L / EA + 40.0 / EA + 0.004, 0.65 * L / EA + 15.0 / EA
    pulled = 25.0 + 0.5 * 10.0 / (before + behind + 1.0 / kL)  # half of the stroke
    loss = pulled * (math.exp(math.pi / 16.0) - math.exp(-math.pi / 16.0))
    expected = 25.0, 1.0 / before, 1.0 / behind, kL, 3.0, 1.5, loss, 1.7, 0.2, 0.3, 0.4, 5.0, 6.0
    assert lumped_of(with_values(GROUP_A, VALUES), 10.0) == pytest.approx(expected)
    assert set(HELD) == {name.split(".")[0] for name in VALUES}


def rubs(force, way, limit):
    """Say whether a point that has gone a way is held by a friction force."""
    return abs(force - math.copysign(limit, way)) < 1e-9 if way else abs(force) < limit + 1e-9


@pytest.mark.parametrize("smooth", ["", "sheath_friction_N", "load_friction_N"])
def test_each_point_balances_and_rests_until_the_springs_exceed_its_friction(smooth):
    lumped = SPRINGS._replace(**{smooth: 0.0} if smooth else {})
    f_in, x_out = follow(lumped, WAYS)
    turned = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0])
    pulls = f_in - 2.0 * WAYS - 1.5 * turned  # less what is beside the tendon
    middle, out = 0.0, 0.0
    for x, pull, place in zip(WAYS, pulls, x_out, strict=True):
        assert pull >= 0.0
        if pull == pytest.approx(0.0, abs=1e-12):  # pushed: what its spring held is not known
            break
        there = x - (pull - 25.0) / 40.0
        passed = 60.0 * (there - place)
        ways = [way if abs(way) > 1e-10 else 0.0 for way in (there - middle, place - out)]
        assert rubs(pull - 25.0 - passed, ways[0], lumped.sheath_friction_N)
        assert rubs(passed - 5.0 * place, ways[1], lumped.load_friction_N)
        middle, out = there, place
    assert x_out[3] > 0.5


def test_a_tendon_that_is_pushed_holds_nothing():
    f_in, _ = follow(SPRINGS._replace(beside_N_per_mm=0.0, drive_friction_N=0.0), -5.0 * WAYS**2)
    assert f_in.min() == 0.0
    assert f_in[0] == 25.0
