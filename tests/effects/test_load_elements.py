"""What is beside the load spring, against the load's equation solved without a chain.

Without friction the tendon is a spring: K (x_in − x) = kL x + the element's force.
"""

import numpy as np
import pytest

from tests.effects.runs import run
from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

KL = GROUP_A.load_stiffness_N_per_mm
K = 4.0  # of the tendon [N/mm]
SOFT = GROUP_A._replace(
    friction_coefficient=1e-9, tendon_stiffness_N=K * GROUP_A.sheath_length_mm, preload_N=40.0
)
BOTH = pytest.mark.parametrize("dynamics", ["slip", "lugre"])


def softly(values, x_in, time_s, dynamics):
    """Return the answer of a rig without friction on a soft tendon."""
    return simulate(with_values(SOFT, values), DriveInput(x_in, time_s=time_s), dynamics)


@BOTH
def test_a_damped_load_comes_late(dynamics):
    """c x′ + (K + kL) x = K r t."""
    t, rate, damping = np.arange(0.0, 2.0, 2e-3), 6.0, 1.5
    answer = softly({"load_damping.coefficient_N_s_per_mm": damping}, rate * t, t, dynamics)
    late = damping / (K + KL)
    exact = K * rate / (K + KL) * (t - late * (1.0 - np.exp(-t / late)))
    assert late > 0.2
    np.testing.assert_allclose(answer.x_out_mm, exact, atol=2e-3 * exact[-1])
    np.testing.assert_allclose(answer.f_out_N, 40.0 + K * (rate * t - exact), atol=0.1)


@pytest.mark.parametrize("speed", [2.0, 8.0])
def test_a_damper_at_the_load_is_felt_by_its_sensor(speed):
    answer = run({"load_damping.coefficient_N_s_per_mm": 0.2}, speed=speed)
    for part, sign in ((slice(500, 690), 1.0), (slice(1100, 1390), -1.0)):
        v_out = np.gradient(answer.x_out_mm[part], 0.02 / speed)
        assert (sign * v_out > 0.5 * speed).all()
        spring = 25.0 + KL * answer.x_out_mm[part]
        np.testing.assert_allclose(answer.f_out_N[part], spring + 0.2 * v_out, atol=1e-6)
