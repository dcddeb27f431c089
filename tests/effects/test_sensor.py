"""What the sensors make of true values, against readings made by hand, and back again."""

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, run
from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

TIME_S = np.arange(UP_AND_DOWN.size) * 0.02
DRIFTED = (1.0 - np.exp(-0.1 * TIME_S)) / 0.1
DRIFT, RIPPLE = "force_sensor_drift", "position_sensor_ripple"
READINGS = [
    ({"force_sensor_gain.f_out_gain": 1.1}, "f_out_N", lambda true: 1.1 * true),
    ({"force_sensor_offset.f_in_offset_N": 0.7}, "f_in_N", lambda true: true + 0.7),
    ({"force_sensor_offset.f_out_offset_N": -0.7}, "f_out_N", lambda true: true - 0.7),
    ({f"{DRIFT}.f_in_rate_N_per_s": 0.03}, "f_in_N", lambda true: true + 0.03 * TIME_S),
    (
        {f"{DRIFT}.f_out_rate_N_per_s": 0.03, f"{DRIFT}.settling_per_s": 0.1},
        "f_out_N",
        lambda true: true + 0.03 * DRIFTED,
    ),
    ({"position_sensor_gain.x_out_gain": 0.97}, "x_out_mm", lambda true: 0.97 * true),
    (
        {f"{RIPPLE}.sine_mm": 0.06, f"{RIPPLE}.cosine_mm": -0.02, f"{RIPPLE}.period_mm": 4.0},
        "x_out_mm",
        lambda true: true + 0.06 * np.sin(np.pi * true / 2) - 0.02 * (np.cos(np.pi * true / 2) - 1),
    ),
    (
        {"force_sensor_gain_drift.f_in_rate_per_s": 0.004},
        "f_in_N",
        lambda true: true * (1.0 + 0.004 * TIME_S),
    ),
    (
        {"force_sensor_gain_drift.f_out_rate_per_s": -0.004, "force_sensor_gain.f_out_gain": 1.1},
        "f_out_N",
        lambda true: 1.1 * true * (1.0 - 0.004 * TIME_S),
    ),
]


@pytest.mark.parametrize(("values", "channel", "law"), READINGS)
def test_one_channel_reads_otherwise_and_no_other(values, channel, law):
    plain, read = run({}), run(values)
    for name in ("x_in_mm", "f_in_N", "f_out_N", "x_out_mm"):
        true = getattr(plain, name)
        expected = law(true) if name == channel else true
        np.testing.assert_allclose(getattr(read, name), expected, atol=1e-10)


@pytest.mark.parametrize("channel", ["f_in", "f_out", "x_out"])
@pytest.mark.parametrize("late", [0.1, -0.1])
def test_a_late_channel_shows_what_was(channel, late):
    """Five samples of 20 ms."""
    unit = "mm" if channel == "x_out" else "N"
    plain = getattr(run({}), f"{channel}_{unit}")
    read = getattr(run({f"channel_delay.{channel}_delay_s": late}), f"{channel}_{unit}")
    if late > 0.0:
        np.testing.assert_allclose(read[5:], plain[:-5], atol=1e-9)
    else:
        np.testing.assert_allclose(read[:-5], plain[5:], atol=1e-9)


def test_without_times_nothing_is_late():
    rig = with_values(GROUP_A, {"channel_delay.f_in_delay_s": 0.1})
    without = simulate(GROUP_A, DriveInput(UP_AND_DOWN))
    np.testing.assert_array_equal(simulate(rig, DriveInput(UP_AND_DOWN)).f_in_N, without.f_in_N)
