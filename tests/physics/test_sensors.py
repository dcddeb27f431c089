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
        "force_sensor_drift.f_in_session_rate_N_per_s": 0.01,
        "force_sensor_drift.f_out_session_rate_N_per_s": -0.02,
    },
)._replace(x_out_zero_mm=7.0)
RAMP, SESSION_S = 10.0 * TIMES, 300.0


@pytest.mark.parametrize(
    ("channel", "late", "gain", "shift"),
    [
        ("f_in_N", 0.0, 1.0, 5.0 + 0.1 * TIMES),
        ("f_out_N", 0.5, 1.1, -9.0),
        ("x_out_mm", 0.25, 0.9, 7.0),
    ],
)
def test_a_channel_is_late_scaled_and_shifted(channel, late, gain, shift):
    seen = reading(channel, RAMP, TIMES, SESSION_S, SENSED)
    np.testing.assert_allclose(seen, gain * np.maximum(RAMP - 10.0 * late, 0.0) + shift)
    back = true_value(channel, seen, TIMES, SESSION_S, SENSED)
    np.testing.assert_allclose(back[1:-1], RAMP[1:-1])
    still = reading(channel, RAMP, None, SESSION_S, SENSED)
    np.testing.assert_allclose(still, gain * RAMP + (5.0 if channel == "f_in_N" else shift))


def through_sensors(values, f_in, f_out, memory=None, boundary=DRIVEN, **how):
    """Return what the sensors feel of forces and places at both ends."""
    x_in, x_out = how.get("x_in", 0.0 * f_in), how.get("x_out", 0.0 * f_in)
    output = Output(x_in, x_out, f_in, f_out, np.zeros(f_in.size, dtype=np.int8))
    memory = new_memory() if memory is None else memory
    rig, others = with_values(GROUP_A, values), (how.get("time_s"), how.get("motor_mm"))
    return sensed(output, others[0], rig, boundary, memory, others[1])


def test_a_sensors_element_is_without_force_at_first_and_yields_at_its_span():
    """Until then the reading lags by a share of all that has come, and later by one of the span."""
    loops = {"f_in_share": 0.1, "f_out_share": 0.2, "span_N": 4.0}
    values = {f"force_sensor_hysteresis.{name}": value for name, value in loops.items()}
    force = np.array([50.0, 52.0, 58.0, 55.0, 53.0, 40.0, 41.0])
    memory = new_memory()
    parts = [through_sensors(values, f, 0.5 * f, memory) for f in (force[:3], force[3:])]
    f_in, f_out = (np.concatenate([getattr(p, name) for p in parts]) for name in ("f_in", "f_out"))
    np.testing.assert_allclose(f_in, force - 0.1 * np.array([0, 2, 4, 1, -1, -4, -3]))
    np.testing.assert_allclose(f_out, 0.5 * force - 0.2 * np.array([0, 1, 4, 2.5, 1.5, -4, -3.5]))


def test_a_low_pass_rests_at_first_and_then_follows_a_ramp_by_its_time():
    """τ dy/dt = u − y, of a rise by 10/s: it lags by 10 τ (1 − e^(−t/τ)), whatever the steps."""
    lags = {f"sensor_lag.{name}_lag_s": s for name, s in LAGS.items()}
    since, memory = np.array([0.0, 0.1, 0.15, 0.5, 1.5, 1.6]), new_memory()
    time_s, ramp, late = 3.0 + since, 30.0 + 10.0 * since, with_values(GROUP_A, lags)
    parts = [
        through_sensors(lags, ramp[p], ramp[p], memory, time_s=time_s[p], x_out=ramp[p])
        for p in (slice(0, 2), slice(2, None))
    ]
    for channel, (name, s) in zip(CHANNELS, LAGS.items(), strict=True):
        found = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_allclose(found, ramp - 10.0 * s * -np.expm1(-since / s))
        assert getattr(through_sensors(lags, ramp, ramp, x_out=ramp), name) is ramp
        for n in (1, 2, 6):  # the inverse to first order, by its rate
            back = true_value(channel, ramp[:n], time_s[:n], 0.0, late)
            np.testing.assert_allclose(back, ramp[:n] + (10.0 * s if n > 1 else 0.0))
        np.testing.assert_array_equal(true_value(channel, ramp, None, 0.0, late), ramp)


def test_tilt_and_crosstalk_are_of_each_force_that_is_not_given():
    values = {"force_sensor_tilt.f_in_per_mm": 0.01, "force_sensor_tilt.f_out_per_mm": -0.02}
    values |= {"force_crosstalk.f_in_of_f_out": 0.1, "force_crosstalk.f_out_of_f_in": -0.3}
    f_in, f_out, x_in = np.array([50.0, 60.0]), np.array([30.0, 40.0]), np.array([3.0, 4.0])
    drive, load = f_in * (1.0 + 0.01 * x_in) + 0.1 * f_out, f_out * (1.0 - 0.04 * x_in) - 0.3 * f_in
    for boundary, expected in (
        (DRIVEN, (drive, load)),
        (Boundary(FORCE, SPRING), (f_in, load)),
        (Boundary(DISPLACEMENT, FORCE), (drive, f_out)),
    ):
        found = through_sensors(values, f_in, f_out, None, boundary, x_in=x_in, x_out=2.0 * x_in)
        np.testing.assert_allclose((found.f_in, found.f_out), expected)


def test_a_scale_is_bent_and_a_wave_is_read_by_their_own_channels_alone():
    values = {"position_sensor_ripple.sine_mm": 0.1, "position_sensor_ripple.period_mm": 4.0}
    bends = {"force_sensor_curvature.f_in_per_N": 1e-3, "force_sensor_curvature.f_out_per_N": -2e-3}
    values |= bends | {"force_sensor_gain_drift.f_in_rate_per_s": 0.01}
    true, time_s = np.array([0.5, 1.0, 2.0, 5.0]), np.array([0.0, 1.0, 5.0, 6.0])
    expected = (
        (true + 1e-3 * true**2) * (1.0 + 0.01 * time_s),
        true - 2e-3 * true**2,
        true + 0.1 * np.sin(0.5 * math.pi * true),
    )
    for channel, seen in zip(CHANNELS, expected, strict=True):
        rig = with_values(GROUP_A, values)
        np.testing.assert_allclose(reading(channel, true, time_s, 0.0, rig), seen)
        np.testing.assert_allclose(true_value(channel, seen, time_s, 0.0, rig), true, atol=1e-9)


def test_the_laws_of_an_end_act_where_its_quantity_is_not_given():
    """Without force at the first place, by the motor's way and speed."""
    values = {"drive_law.travel_mm": 4.0, "drive_law.friction_1_N": 2.0, "drive_law.speed_2": 0.25}
    values |= {"drive_law.slow_mm_per_s": 0.1, "drive_law.fast_mm_per_s": 100.0}
    values |= {"drive_law.speed_3": 0.5, "load_law.travel_mm": 4.0, "load_law.lost_1_mm": 0.3}
    values |= {"drive_law.low_mm": 5.0, "drive_law.high_mm": 25.0, "drive_law.place_2": 0.2}
    values |= {"drive_law.place_3": 0.4, "drive_law.place_4": 0.6, "drive_law.place_5": 0.8}
    time_s, moved = np.array([0.0, 0.1, 0.6, 0.8, 1.8]), np.array([5.0, 6.0, 8.0, 28.0, 27.0])
    share = np.array([0.0, 0.25, 0.75, 1.0, 0.75])  # of the element, which yields after 4 mm
    fast = np.log10([0.1, 10.0, 4.0, 100.0, 1.0]) + 1.0  # decades over the slow speed
    place = np.array([0.0, 0.04, 0.12, 0.8, 0.8])  # 0.04 for each mm, up to 25 mm
    force, memory = 2.0 * share * (1.0 + 0.5 * fast / 3.0 + place), new_memory()

    def answer(part=slice(None), memory=None, boundary=DRIVEN, **how):
        x = moved[part]
        how = {"x_in": x, "x_out": x, "time_s": time_s[part]} | how
        return through_sensors(values, 0.0 * x, 0.0 * x, memory, boundary, **how)

    parts = [answer(part, memory) for part in (slice(0, 2), slice(2, None))]
    np.testing.assert_allclose(np.concatenate([part.f_in for part in parts]), force)
    np.testing.assert_allclose(np.concatenate([part.x_out for part in parts]), moved - 0.3 * share)
    by_motor = answer(motor_mm=moved, x_in=5.0 + 0.0 * moved).f_in  # the place is the drive's
    np.testing.assert_allclose(by_motor, 2.0 * share * (1.0 + 0.5 * fast / 3.0))
    np.testing.assert_allclose(answer(time_s=None).f_in, 2.0 * share * (1.0 + place))
    given = answer(boundary=Boundary(FORCE, DISPLACEMENT))
    np.testing.assert_array_equal((given.f_in, given.x_out), (0.0 * moved, moved))
