"""The slope of each phase."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tsas_cli.identification.phases import Segment
from tsas_cli.identification.transfer import slopes

X = np.concatenate((np.linspace(0.0, 10.0, 2000), np.linspace(10.0, 0.0, 2000)))
PARTS = [Segment(0, 2000, "contraction"), Segment(2000, 4000, "loosening")]


def by_phase(found):
    return {s.phase: s for s in found}


def test_each_phase_has_its_own_slope():
    f = np.where(np.arange(4000) < 2000, 2.3 * X, 1.1 * X + 12.0)
    found = by_phase(slopes(X, f, PARTS))
    assert found["contraction"].value == pytest.approx(2.3)
    assert found["loosening"].value == pytest.approx(1.1)


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


def left_out(strokes, size):
    """Return the error of a slope from refits, each without one block of neighbours.

    Where a block is left out, the means that the others were counted from stay.
    """
    x, f = (np.concatenate([part - part.mean() for part in parts]) for parts in strokes)
    slopes = []
    for first in range(0, x.size, size):
        rest = np.ones(x.size, dtype=bool)
        rest[first : first + size] = False
        slopes.append(x[rest] @ f[rest] / (x[rest] @ x[rest]))
    spread = np.array(slopes) - np.mean(slopes)
    return np.sqrt((len(slopes) - 1) / len(slopes) * spread @ spread)


def test_a_slope_and_its_error_by_hand():
    """Errors that go up and down in turns have no memory: blocks are of four samples."""
    x = np.tile(np.linspace(0.0, 5.0, 40), 3)
    off = np.where(np.arange(120) % 2 == 0, 1.0, -1.0) * np.linspace(0.1, 0.3, 120)
    f = 2.0 * x + np.repeat([10.0, 30.0, 20.0], 40) + off
    parts = [Segment(0, 40, "contraction"), Segment(40, 80, "loosening")]
    parts += [Segment(80, 120, "contraction")]
    kept = [slice(0, 40), slice(80, 120)]
    found = by_phase(slopes(x, f, parts))["contraction"]
    xs, fs = ([values[part] - values[part].mean() for part in kept] for values in (x, f))
    square = sum(part @ part for part in xs)
    assert found.value == pytest.approx(sum(a @ b for a, b in zip(xs, fs, strict=True)) / square)
    assert found.stderr == pytest.approx(left_out((xs, fs), 4), rel=1e-6)
    assert 1.9 < found.half_width / found.stderr < 2.5  # Student's
    assert (found.occurrences, found.samples) == (2, 80)


def test_what_tells_no_slope():
    x = np.linspace(0.0, 5.0, 40)
    assert slopes(x, 2.0 * x, []) == []
    five, six = ([Segment(0, n, "contraction")] for n in (5, 6))
    assert slopes(x, 2.0 * x, five) == []
    assert by_phase(slopes(x, 2.0 * x, six))["contraction"].samples == 6
    assert slopes(0.0 * x, x, [Segment(0, 40, "contraction")]) == []
    hardly = 1e-3 * x  # squares of far less than one
    assert by_phase(slopes(hardly, x, six))["contraction"].value == pytest.approx(1e3)
    gone = x.copy()
    gone[3:] = np.nan
    both = [Segment(0, 20, "contraction"), Segment(20, 40, "contraction")]
    assert slopes(gone, x, both) == []
    gone[20:] = x[20:]
    assert by_phase(slopes(gone, x, both))["contraction"].occurrences == 1


def test_slopes_come_in_the_order_of_the_phases():
    x = np.linspace(0.0, 5.0, 40)
    names = ("dead_band_down", "loosening", "unknown", "contraction")
    parts = [Segment(10 * k, 10 * k + 10, name) for k, name in enumerate(names)]
    found = [s.phase for s in slopes(x, 2.0 * x, parts)]
    assert found == ["contraction", "loosening", "dead_band_down"]
