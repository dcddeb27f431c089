import numpy as np
import pytest

from tsas_cli.reporting.drawing import CELLS, kept_cells, kept_samples


def test_a_single_spike_and_the_last_sample_are_kept():
    values = np.random.default_rng(1).normal(size=100_003)
    values[70_001], values[70_002] = 50.0, -60.0
    kept = kept_samples(values)
    assert {0, 70_001, 70_002, 100_002} <= set(kept)
    assert np.all(np.diff(kept) > 0)


@pytest.mark.parametrize("size", [3201, 20_000, 1_000_000])
def test_about_as_many_points_as_asked_for(size):
    assert 500 < kept_samples(np.random.default_rng(2).normal(size=size), points=1000).size <= 1010


def test_extremes_of_both_axes_of_a_loop_are_kept():
    x, y = np.random.default_rng(3).normal(size=(2, 50_000))
    kept = kept_samples(x, y)
    for values in (x, y):
        assert values[kept].min() == values.min()
        assert values[kept].max() == values.max()


def test_a_gap_stays_a_gap():
    values = np.sin(np.linspace(0, 10, 50_000))
    values[20_000:30_000] = np.nan
    kept = kept_samples(values)
    assert np.isnan(values[kept]).sum() >= 1
    assert not np.isnan(values[kept[kept < 19_000]]).any()


def test_a_curve_that_hurries_and_waits_keeps_its_shape():
    """Once round in 50 of 10,000 samples, then a rest with a little noise."""
    angle = np.minimum(np.arange(10_000) / 50, 1.0) * 2 * np.pi
    noise = np.random.default_rng(4).normal(scale=1e-4, size=(2, angle.size))
    x, y = np.cos(angle) + noise[0], np.sin(angle) + noise[1]
    kept = kept_cells(x, y)
    assert {*range(51), angle.size - 1} <= set(kept)
    slow = np.linspace(0.0, 2 * np.pi, 10_000)
    x, y = np.cos(slow), np.sin(slow)
    kept = kept_cells(x, y)
    assert kept.size < 4.5 * CELLS
    assert np.hypot(np.diff(x[kept]), np.diff(y[kept])).max() < 2 / CELLS * np.sqrt(2)


def test_a_short_series_is_kept_whole_and_a_curve_that_does_not_move_is_its_ends():
    assert kept_samples(np.full(10, np.nan)).tolist() == list(range(10))
    assert kept_cells(np.zeros(500), np.ones(500)).tolist() == [0, 499]
