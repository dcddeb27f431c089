"""What happens to a signal before it is sampled, against closed forms."""

import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.sensors import Sensor, Sensors, measure
from tsas_studies.challenge.rig.tendon import CleanRun
from tsas_studies.challenge.rig.transducers import Transducer, transduced

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
