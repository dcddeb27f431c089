import math

import numpy as np
import pytest

from tsas_cli.diagnosis.motions import motion

KINDS = ("sine", "ramps", "steps", "nested", "chirp")


def moved(kind, **changed):
    usual = {"amplitude_mm": 7.0, "speed_mm_per_s": 5.0, "periods": 2, "dwell_s": 0.0}
    return motion(kind, rate_Hz=500.0, **usual | changed)


@pytest.mark.parametrize("kind", KINDS)
def test_the_stroke_is_twice_the_amplitude_and_the_speed_is_reached(kind):
    _, x = moved(kind)
    assert x[0] == pytest.approx(0.0, abs=0.1)
    assert x[-1] == pytest.approx(0.0, abs=0.1)
    assert (x.min(), x.max()) == pytest.approx((0.0, 14.0), abs=0.2)
    assert np.abs(np.diff(x)).max() * 500.0 == pytest.approx(5.0, rel=0.08)


def test_a_sine_is_the_formula():
    t, x = moved("sine")
    assert x == pytest.approx(7.0 * (1.0 - np.cos(5.0 / 7.0 * t)), abs=1e-9)
    assert t[-1] == pytest.approx(2 * 2.0 * math.pi * 7.0 / 5.0, abs=0.002)


def test_ramps_take_their_way_at_their_speed():
    t, _ = moved("ramps", periods=3)
    assert t[-1] == pytest.approx(3 * 2 * 14.0 / 5.0, abs=0.002)


def test_steps_rest_on_every_level():
    t, x = moved("steps", periods=1, dwell_s=2.0)
    at_rest = np.abs(np.gradient(x, t)) < 1e-6
    assert np.unique(np.round(x[at_rest], 6)) == pytest.approx([0.0, 3.5, 7.0, 10.5, 14.0])
    assert at_rest.sum() / 500.0 == pytest.approx(8 * 2.0, abs=8 * 0.12)


def test_a_chirp_ends_ten_times_as_fast_as_it_begins():
    t, x = moved("chirp", periods=8)
    turns = t[1:-1][np.diff(np.sign(np.diff(x))) != 0]
    last = 1.0 / (2.0 * (turns[-1] - turns[-2]))
    assert last == pytest.approx(5.0 / (2.0 * math.pi * 7.0), rel=0.1)
    quarter = np.interp(7.0, x[: int(turns[0] * 500)], t[: int(turns[0] * 500)])
    assert 0.1 < 0.25 / quarter / (5.0 / (2.0 * math.pi * 7.0)) < 0.2
