"""What a sensor reads of a true value, and the value behind a reading."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.course import Output
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.sensors import CHANNELS, new_memory, reading, sensed, true_value

DRIVEN = Boundary(DISPLACEMENT, SPRING)
LAGS = {"f_in": 0.2, "f_out": 0.05, "x_out": 0.1}  # [s]
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


def through_sensors(f_in, f_out, values, *, time_s=None, memory=None, boundary=DRIVEN, **motion):
    """Return what the sensors feel of forces and places at both ends."""
    n = len(f_in)
    x_in, x_out = (np.array(motion.get(name, np.zeros(n))) for name in ("x_in", "x_out"))
    output = Output(x_in, x_out, np.array(f_in), np.array(f_out), np.zeros(n, dtype=np.int8))
    rig, memory = with_values(GROUP_A, values), new_memory() if memory is None else memory
    return sensed(output, time_s, rig, boundary, memory, motion.get("motor_mm"))


def test_a_sensors_element_is_without_force_at_first_and_yields_at_its_span():
    """Until then the reading lags by a share of all that has come, and later by one of the span."""
    loops = {"f_in_share": 0.1, "f_out_share": 0.2, "span_N": 4.0}
    values = {f"force_sensor_hysteresis.{name}": value for name, value in loops.items()}
    force = np.array([50.0, 52.0, 58.0, 55.0, 53.0, 40.0, 41.0])
    element = np.array([0.0, 2.0, 4.0, 1.0, -1.0, -4.0, -3.0])
    found = through_sensors(force, 2.0 * force, values)
    np.testing.assert_allclose(found.f_in, force - 0.1 * element)
    twice = np.array([0.0, 4.0, 4.0, -2.0, -4.0, -4.0, -2.0])
    np.testing.assert_allclose(found.f_out, 2.0 * force - 0.2 * twice)
    memory = new_memory()
    parts = [through_sensors(f, f, values, memory=memory).f_in for f in (force[:3], force[3:])]
    np.testing.assert_array_equal(np.concatenate(parts), found.f_in)


def test_a_low_pass_rests_at_first_and_then_follows_a_ramp_by_its_time():
    """τ dy/dt = u − y, of a rise by 10/s: it lags by 10 τ (1 − e^(−t/τ)), whatever the steps."""
    lags = {f"sensor_lag.{name}_lag_s": s for name, s in LAGS.items()}
    time_s = 3.0 + np.array([0.0, 0.1, 0.15, 0.5, 1.5, 1.6])
    since, ramp = time_s - 3.0, 10.0 * time_s
    found = through_sensors(ramp, ramp, lags, time_s=time_s, x_out=ramp)
    for column, s in zip((found.f_in, found.f_out, found.x_out), LAGS.values(), strict=True):
        np.testing.assert_allclose(column, ramp - 10.0 * s * -np.expm1(-since / s))
    memory, parts = new_memory(), []
    for part in (slice(0, 2), slice(2, None)):
        f = ramp[part]
        parts.append(through_sensors(f, f, lags, time_s=time_s[part], memory=memory, x_out=f))
    for name in ("f_in", "f_out", "x_out"):
        pieces = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_allclose(pieces, getattr(found, name))
    still = through_sensors(ramp, ramp, lags, x_out=ramp)
    np.testing.assert_array_equal(still.f_in, ramp)
    late = with_values(GROUP_A, lags)
    for channel, s in zip(CHANNELS, LAGS.values(), strict=True):
        back = true_value(channel, ramp, time_s, late)  # to first order, by its rate
        np.testing.assert_allclose(back, ramp + 10.0 * s)
        for few, times in ((ramp, None), (ramp[:1], time_s[:1])):
            np.testing.assert_array_equal(true_value(channel, few, times, late), few)
        two = true_value(channel, ramp[:2], time_s[:2], late)
        np.testing.assert_allclose(two, ramp[:2] + 10.0 * s)


def test_tilt_and_crosstalk_are_of_each_force_that_is_not_given():
    values = {
        "force_sensor_tilt.f_in_per_mm": 0.01,
        "force_sensor_tilt.f_out_per_mm": -0.02,
        "force_crosstalk.f_in_of_f_out": 0.1,
        "force_crosstalk.f_out_of_f_in": -0.3,
    }
    ends = {"x_in": [3.0, 4.0], "x_out": [1.0, 2.0]}
    f_in, f_out = np.array([50.0, 60.0]), np.array([30.0, 40.0])
    drive = f_in * (1.0 + 0.01 * np.array([3.0, 4.0])) + 0.1 * f_out
    load = f_out * (1.0 - 0.02 * np.array([1.0, 2.0])) - 0.3 * f_in
    for boundary, expected in (
        (DRIVEN, (drive, load)),
        (Boundary(FORCE, SPRING), (f_in, load)),
        (Boundary(DISPLACEMENT, FORCE), (drive, f_out)),
    ):
        found = through_sensors(f_in, f_out, values, boundary=boundary, **ends)
        np.testing.assert_allclose((found.f_in, found.f_out), expected)


def test_a_scale_is_bent_and_a_wave_is_read_by_their_own_channels_alone():
    wave = {"sine_mm": 0.1, "cosine_mm": 0.2, "period_mm": 4.0}
    values = {f"position_sensor_ripple.{name}": value for name, value in wave.items()}
    values |= {"force_sensor_curvature.f_in_per_N": 1e-3, "force_sensor_curvature.f_out_per_N": -2e-3}
    values |= {"force_sensor_gain_drift.f_in_rate_per_s": 0.01, "force_sensor_gain.f_out_gain": 1.1}
    rig, true = with_values(GROUP_A, values), np.array([0.5, 1.0, 2.0, 5.0])
    time_s, angle = np.array([0.0, 1.0, 5.0, 6.0]), 0.5 * math.pi * true
    expected = {
        "f_in_N": (true + 1e-3 * true**2) * (1.0 + 0.01 * time_s),
        "f_out_N": 1.1 * (true - 2e-3 * true**2),
        "x_out_mm": true + 0.1 * np.sin(angle) + 0.2 * (np.cos(angle) - 1.0),
    }
    for channel, values_read in expected.items():
        np.testing.assert_allclose(reading(channel, true, time_s, rig), values_read)
        np.testing.assert_allclose(true_value(channel, values_read, time_s, rig), true, atol=1e-9)
    bare = with_values(GROUP_A, {"force_sensor_curvature.f_in_per_N": 1e-3})
    assert reading("f_in_N", true, None, bare).tolist() == pytest.approx(true + 1e-3 * true**2)
    np.testing.assert_array_equal(reading("x_out_mm", true, None, bare), true)


def test_the_laws_of_an_end_act_where_its_quantity_is_not_given():
    """Without force at the first place, by the motor's way and speed."""
    values = {
        "drive_law.travel_mm": 4.0,
        "drive_law.friction_1_N": 2.0,
        "drive_law.slow_mm_per_s": 0.1,
        "drive_law.fast_mm_per_s": 100.0,
        "drive_law.speed_2": 0.25,
        "drive_law.speed_3": 0.5,
        "load_law.travel_mm": 4.0,
        "load_law.lost_1_mm": 0.3,
        "load_law.compliance_mm_per_N": 0.01,
    }
    time_s, moved = np.array([0.0, 0.1, 0.6, 0.8, 1.8]), np.array([5.0, 6.0, 8.0, 28.0, 27.0])
    share = np.array([0.0, 0.25, 0.75, 1.0, 0.75])  # of the element, which yields after 4 mm
    fast = np.log10([0.1, 10.0, 4.0, 100.0, 1.0]) + 1.0  # decades over the slow speed
    force, lost = 2.0 * share * (1.0 + 0.5 * fast / 3.0), 0.3 * share + 0.01 * 7.0

    def answer(part=slice(None), boundary=DRIVEN, memory=None, **how):
        x, f_out = moved[part], np.full(moved[part].size, 7.0)
        how = {"x_in": x, "x_out": x, "time_s": time_s[part]} | how
        return through_sensors(0.0 * x, f_out, values, boundary=boundary, memory=memory, **how)

    found = answer()
    np.testing.assert_allclose((found.f_in, found.x_out), (force, moved - lost))
    np.testing.assert_allclose(answer(motor_mm=moved, x_in=0.0 * moved).f_in, force)
    np.testing.assert_allclose(answer(time_s=None).f_in, 2.0 * share)
    given = answer(boundary=Boundary(FORCE, DISPLACEMENT))
    np.testing.assert_array_equal((given.f_in, given.x_out), (0.0 * moved, moved))
    memory = new_memory()
    parts = [answer(part, memory=memory) for part in (slice(0, 2), slice(2, None))]
    np.testing.assert_allclose(np.concatenate([part.f_in for part in parts]), force)
    np.testing.assert_allclose(np.concatenate([part.x_out for part in parts]), moved - lost)
