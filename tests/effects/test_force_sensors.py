"""What force sensors make of a tension, against the same made by hand: curve, loop, crosstalk."""

import numpy as np
import pytest

from tests.effects.runs import run
from tests.physics.references import GROUP_A
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.sensors import true_value

CHANNELS = ("x_in_mm", "f_in_N", "f_out_N", "x_out_mm")


def changed_alone(values, channel, law):
    """Hold one channel against a law of both true tensions, and all others against no change."""
    plain, read = run({}), run(values)
    for name in CHANNELS:
        true = getattr(plain, name)
        expected = law(plain.f_in_N, plain.f_out_N) if name == channel else true
        np.testing.assert_allclose(getattr(read, name), expected, atol=1e-9)


@pytest.mark.parametrize("channel", ["f_in", "f_out"])
def test_a_curved_scale_is_a_parabola(channel):
    def law(f_in, f_out):
        true = f_in if channel == "f_in" else f_out
        return true - 3e-4 * true**2

    changed_alone({f"force_sensor_curvature.{channel}_per_N": -3e-4}, f"{channel}_N", law)


def test_a_curved_scale_is_right_without_force_and_has_a_slope_of_one_there():
    assert read_curved(0.0, 1e-3) == 0.0
    assert (read_curved(1e-6, 1e-3) - read_curved(-1e-6, 1e-3)) / 2e-6 == pytest.approx(1.0)
    assert read_curved(50.0, 4e-4) == pytest.approx(51.0)


@pytest.mark.parametrize("curvature", [-2e-3, 0.0, 2e-3])
def test_a_reading_of_a_curved_scale_has_one_force(curvature):
    forces = np.array([-20.0, 0.0, 25.0, 120.0])
    back = straightened(read_curved(forces, curvature), curvature)
    np.testing.assert_allclose(back, forces, rtol=1e-12)
    assert straightened(1e3, -2e-3) == pytest.approx(2e3)  # beyond the vertex, which reads 125 N


def test_a_measured_load_is_taken_back_to_its_force():
    rig = with_values(GROUP_A, {"force_sensor_curvature.f_out_per_N": 5e-4})
    true = np.array([20.0, 40.0, 60.0])
    np.testing.assert_allclose(true_value("f_out_N", true + 5e-4 * true**2, None, rig), true)
