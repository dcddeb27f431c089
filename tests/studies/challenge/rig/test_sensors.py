import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.sensors import PERFECT, Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import CleanRun

TIME = np.arange(20001) / 1000.0


def ramp(speed=2.0):
    return CleanRun({"time_s": TIME, "x_in_mm": speed * TIME, "f_in_N": 30.0 + speed * TIME})


def test_perfect_sensors_change_nothing():
    columns = measure(ramp(), PERFECT, seed=1)
    for name, values in ramp().columns.items():
        np.testing.assert_allclose(columns[name], values, atol=1e-12)


def test_noise_and_steps_are_each_channels_own():
    sensors = Sensors(x_in_mm=Sensor(noise=0.005), f_in_N=Sensor(noise=0.1, step=0.5))
    columns = measure(ramp(), sensors, seed=1)
    error = columns["x_in_mm"] - 2.0 * TIME
    assert error.std() == pytest.approx(0.005, rel=0.03)
    assert abs(error.mean()) < 2e-4
    assert np.all(columns["f_in_N"] % 0.5 == 0.0)
    other = columns["f_in_N"] - 30.0 - 2.0 * TIME
    assert other.std() == pytest.approx(math.hypot(0.1, 0.5 / math.sqrt(12.0)), rel=0.05)
    assert abs(np.corrcoef(error, other)[0, 1]) < 0.03


def test_slow_noise_has_its_size_and_memory():
    still = CleanRun({"time_s": np.arange(400001) / 100.0, "f_in_N": np.zeros(400001)})
    slow = Sensor(slow_noise=0.3, slow_time_s=0.5)
    values = measure(still, Sensors(rate_Hz=100.0, f_in_N=slow), seed=3)["f_in_N"]
    assert values.std() == pytest.approx(0.3, rel=0.05)
    assert np.corrcoef(values[:-50], values[50:])[0, 1] == pytest.approx(math.exp(-1.0), abs=0.05)


def test_jitter_shows_in_motion_only_and_the_clock_stays_even():
    def spread(speed):
        sensors = Sensors(jitter_s=1e-4, x_in_mm=Sensor(), f_in_N=Sensor())
        columns = measure(ramp(speed), sensors, seed=1)
        np.testing.assert_array_equal(columns["time_s"], TIME)
        return (columns["x_in_mm"] - speed * TIME)[100:-100].std()

    assert spread(0.0) == 0.0
    assert spread(5.0) == pytest.approx(5e-4, rel=0.05)


def test_rate():
    columns = measure(ramp(), Sensors(rate_Hz=200.0), seed=1)
    assert columns["time_s"].size == columns["x_in_mm"].size == 4001
    assert np.diff(columns["time_s"]) == pytest.approx(0.005)


def test_a_seed_tells_the_recording():
    one, again, other = (measure(ramp(), Sensors(), seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one["f_in_N"], again["f_in_N"])
    assert np.any(one["f_in_N"] != other["f_in_N"])


def test_wrong_gain_offset_drift_and_hum_add_up_as_written():
    still = CleanRun({"time_s": TIME, "f_in_N": np.full(TIME.size, 40.0)})
    sensor = Sensor(gain=1.1, offset=-2.0, rate_per_s=0.1, settling_per_s=0.2, hum=0.5, hum_Hz=3.0)
    values = measure(still, Sensors(f_in_N=sensor), seed=1)["f_in_N"]
    drift = 0.1 * (1.0 - np.exp(-0.2 * TIME)) / 0.2
    hum = 0.5 * np.sin(6.0 * np.pi * TIME)
    np.testing.assert_allclose(values, 44.0 - 2.0 + drift + hum, atol=1e-9)
    even = measure(still, Sensors(f_in_N=Sensor(rate_per_s=0.1)), seed=1)["f_in_N"]
    np.testing.assert_allclose(even, 40.0 + 0.1 * TIME, atol=1e-9)


def test_lost_counts_stay_lost():
    sensor = Sensor(jumps=((2.0, -0.1), (5.0, -0.3)))
    x = measure(ramp(), Sensors(x_in_mm=sensor), seed=1)["x_in_mm"] - 2.0 * TIME
    for at, off in ((1.999, 0.0), (2.0, -0.1), (4.999, -0.1), (5.0, -0.3), (20.0, -0.3)):
        assert x[round(at * 1000)] == pytest.approx(off)
