"""What the sensors make of true values, against readings made by hand, and back again."""

import math

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, run
from tests.physics.references import GROUP_A
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.effects.position_sensor_ripple import without_ripple
from tsas_cli.numerics.settling import lag_after
from tsas_cli.numerics.wave import Wave, rippled
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

TIME_S = np.arange(UP_AND_DOWN.size) * 0.02
DRIFTED = (1.0 - np.exp(-0.1 * TIME_S)) / 0.1
DRIFT, RIPPLE = "force_sensor_drift", "position_sensor_ripple"
READINGS = [  # single ones: physics/test_sensors.py
    (
        {f"{DRIFT}.f_out_rate_N_per_s": 0.03, f"{DRIFT}.settling_per_s": 0.1},
        "f_out_N",
        lambda true: true + 0.03 * DRIFTED,
    ),
    (
        {f"{RIPPLE}.sine_mm": 0.06, f"{RIPPLE}.cosine_mm": -0.02, f"{RIPPLE}.period_mm": 4.0},
        "x_out_mm",
        lambda true: true + 0.06 * np.sin(np.pi * true / 2) - 0.02 * (np.cos(np.pi * true / 2) - 1),
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


LAG = 0.08


def test_after_a_step_a_low_pass_comes_by_an_exponential():
    behind = 4.0
    for _ in range(3):
        behind = lag_after(behind, 0.0, 0.05, LAG)
    assert behind == pytest.approx(4.0 * math.exp(-0.15 / LAG))
    assert lag_after(4.0, 9.0, math.inf, LAG) == 0.0


@pytest.mark.parametrize("curvature", [-2e-3, 0.0, 2e-3])
def test_a_reading_of_a_curved_scale_has_one_force(curvature):
    forces = np.array([-20.0, 0.0, 25.0, 120.0])
    back = straightened(read_curved(forces, curvature), curvature)
    np.testing.assert_allclose(back, forces, rtol=1e-12)
    assert straightened(1e3, -2e-3) == pytest.approx(2e3)  # beyond the vertex, which reads 125 N


def test_a_wave_too_steep_has_no_position():
    gentle, steep = Wave(0.2, -0.1, 4.0, 0.1, -0.2), Wave(0.0, 0.9, 2.0)
    assert without_ripple(rippled(3.3, gentle), gentle) == pytest.approx(3.3, abs=1e-10)
    assert any(np.isnan(without_ripple(x, steep)) for x in np.linspace(-3.0, 3.0, 200))


def test_a_drive_by_force_is_taken_with_the_loop_that_it_has():
    drive = DriveInput(run({}).f_in_N, kind="force")
    rig = with_values(GROUP_A, {"force_sensor_hysteresis.f_in_share": 0.05})
    with_it, without = simulate(rig, drive), simulate(GROUP_A, drive)
    np.testing.assert_array_equal(with_it.x_in_mm, without.x_in_mm)
    np.testing.assert_array_equal(with_it.f_in_N, without.f_in_N)
