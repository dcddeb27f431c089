import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.sensors import PERFECT, Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import CleanRun
from tsas_studies.challenge.rig.transducers import Transducer, transduced

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


T = np.arange(8001) / 400.0


def through_it(signal, **options):
    return transduced(Transducer(**options), T, signal)


def test_no_transducer_changes_nothing():
    signal = 30.0 + np.sin(T)
    assert through_it(signal) is signal


def test_a_butterworth_filter_halves_the_power_at_its_cut_off():
    sine = 30.0 + np.sin(2.0 * np.pi * 8.0 * T)
    out = through_it(sine, filter_s=1.0 / (2.0 * np.pi * 8.0))
    settled = T > 2.0
    assert np.std(out[settled]) / np.std(sine[settled]) == pytest.approx(math.sqrt(0.5), rel=1e-3)
    # 8 Hz is 50 samples at 400 Hz; a quarter turn late at the cut-off is 12.5 of them.
    late = np.argmax(np.correlate(out[800:4800] - 30.0, sine[800:4750] - 30.0))
    assert late in (12, 13)
    np.testing.assert_allclose(through_it(np.full(T.size, 30.0), filter_s=0.02), 30.0, atol=1e-9)


def test_creep_reads_its_share_late():
    step = np.where(T < 1.0, 20.0, 40.0)
    out = through_it(step, creep_share=0.1, creep_s=2.0)
    after = T > 1.01
    expected = 40.0 - 0.1 * 20.0 * np.exp(-(T - 1.0) / 2.0)
    np.testing.assert_allclose(out[after], expected[after], atol=5e-3)


def test_hysteresis_reads_less_on_the_way_up_and_more_on_the_way_down():
    signal = 60.0 - 40.0 * np.cos(np.pi * T)
    off = through_it(signal, hysteresis_share=0.1, hysteresis_span=5.0) - signal
    up = np.diff(signal, append=signal[-1]) > 0.0
    middle = np.abs(signal - 60.0) < 5.0
    assert off[up & middle] == pytest.approx(-0.5, abs=0.01)
    assert off[~up & middle & (T > 1.0)] == pytest.approx(0.5, abs=0.01)


def test_an_encoder_with_play_follows_late():
    x = 5.0 * (1.0 - np.cos(T))
    off = through_it(x, play=0.2) - x
    assert off[(T > 1.0) & (T < 3.0)] == pytest.approx(-0.1)
    assert off[(T > 4.0) & (T < 6.0)] == pytest.approx(0.1)


def clean(f_in, f_out):
    return CleanRun({"time_s": T, "x_out_mm": f_in / 10.0, "f_in_N": f_in, "f_out_N": f_out})


def quiet(**more):
    return Sensors(rate_Hz=400.0, x_out_mm=Sensor(), f_in_N=Sensor(), f_out_N=Sensor(), **more)


def test_each_channel_has_its_own_transducer():
    run = clean(30.0 + 2.0 * T, 20.0 + T)
    columns = measure(run, quiet(f_out_transducer=Transducer(lag_s=0.1)), seed=0)
    np.testing.assert_array_equal(columns["f_in_N"], run.columns["f_in_N"])
    assert columns["f_out_N"][-1] == pytest.approx(20.0 + T[-1] - 0.1)
