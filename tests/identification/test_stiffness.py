"""The slope of each phase."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tests.identification.recorded import clean
from tsas_cli.challenge.rig.tendon import Rig
from tsas_cli.identification.phases import Segment
from tsas_cli.identification.stiffness import slopes

X = np.concatenate((np.linspace(0.0, 10.0, 2000), np.linspace(10.0, 0.0, 2000)))
PARTS = [Segment(0, 2000, "contraction"), Segment(2000, 4000, "loosening")]


def by_phase(found):
    return {s.phase: s for s in found}


def test_each_phase_has_its_own_slope():
    f = np.where(np.arange(4000) < 2000, 2.3 * X, 1.1 * X + 12.0)
    found = by_phase(slopes(X, f, PARTS))
    assert found["contraction"].value == pytest.approx(2.3)
    assert found["loosening"].value == pytest.approx(1.1)


def test_each_occurrence_has_its_own_intercept():
    x = np.tile(np.linspace(0.0, 5.0, 500), 2)
    f = 2.0 * x + np.repeat([10.0, 30.0], 500)
    parts = [Segment(0, 500, "contraction"), Segment(500, 1000, "contraction")]
    (found,) = slopes(x, f, parts)
    assert found.value == pytest.approx(2.0)
    assert found.occurrences == 2


def test_gaps_are_left_out():
    f = 2.3 * X
    f[100:200] = np.nan
    assert by_phase(slopes(X, f, PARTS))["contraction"].value == pytest.approx(2.3)


def test_the_interval_holds_under_coloured_noise():
    held = []
    for seed in range(200):
        noise = lfilter([0.2], [1.0, -0.98], np.random.default_rng(seed).normal(size=4000))
        found = by_phase(slopes(X, 2.3 * X + noise, PARTS))["contraction"]
        held.append(abs(found.value - 2.3) < found.half_width)
    assert 0.87 < np.mean(held) <= 0.99


def test_a_line_through_the_whole_dead_band_is_biased_by_the_model():
    """Evenly spaced points give 133.6 unloading and 147.1 reloading, not the secant 175.1."""
    columns = clean(Rig()).columns
    x, f_in, f_out = columns["x_in_mm"], columns["f_in_N"], columns["f_out_N"]
    up = np.gradient(x) > 0.0
    still = np.abs(np.gradient(f_out)) < 0.02 * np.abs(np.gradient(x))
    for rising, expected in ((False, 133.6), (True, 147.1)):
        band = np.flatnonzero(still & (up == rising) & (np.arange(x.size) > 2000))
        one = np.split(band, np.flatnonzero(np.diff(band) > 1) + 1)[0]
        even = np.linspace(x[one].min(), x[one].max(), 400)
        order = np.argsort(x[one])
        f = np.interp(even, x[one][order], f_in[one][order])
        (found,) = slopes(even, f, [Segment(0, 400, "dead_band_up")])
        assert found.value == pytest.approx(expected, rel=0.02)
