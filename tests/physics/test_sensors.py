"""What a sensor reads of a true value, and the value behind a reading."""

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.sensors import reading, true_value

TIMES = np.arange(9.0)
SENSED = with_values(
    GROUP_A,
    {
        "channel_delay.f_out_delay_s": 0.5,
        "channel_delay.x_out_delay_s": 0.25,
        "force_sensor_gain.f_out_gain": 1.1,
        "position_sensor_gain.x_out_gain": 0.9,
        "force_sensor_offset.f_in_offset_N": 2.0,
        "force_sensor_offset.f_out_offset_N": -3.0,
        "force_sensor_drift.f_in_rate_N_per_s": 0.1,
    },
)._replace(x_out_zero_mm=7.0)
RAMP = 10.0 * TIMES


@pytest.mark.parametrize(
    ("channel", "late", "gain", "shift"),
    [
        ("f_in_N", 0.0, 1.0, 2.0 + 0.1 * TIMES),
        ("f_out_N", 0.5, 1.1, -3.0),
        ("x_out_mm", 0.25, 0.9, 7.0),
    ],
)
def test_a_channel_is_late_scaled_and_shifted(channel, late, gain, shift):
    seen = reading(channel, RAMP, TIMES, SENSED)
    np.testing.assert_allclose(seen, gain * np.maximum(RAMP - 10.0 * late, 0.0) + shift)
    back = true_value(channel, seen, TIMES, SENSED)
    np.testing.assert_allclose(back[1:-1], RAMP[1:-1])
    still = reading(channel, RAMP, None, SENSED)
    np.testing.assert_allclose(still, gain * RAMP + (2.0 if channel == "f_in_N" else shift))
