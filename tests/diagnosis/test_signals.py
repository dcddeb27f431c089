"""What an error is held against: signals, bins, hats; by hand, on a few samples."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.remainder import hats, regressed
from tsas_cli.diagnosis.residual_map import binned, edges_of
from tsas_cli.diagnosis.signals import DIRECTION, signal_in_words, signals_of

X = np.array([0.0, 1.0, 3.0, 2.0, 1.0, 1.5, 2.5])
TIME_S = 10.0 + 0.5 * np.arange(7)
REVERSALS = np.array([0, 2, 4, 6])


def run_of(column="x_in_mm", reversals=REVERSALS, values=X):
    conditioned = SimpleNamespace(values=values, reversals=reversals)
    return SimpleNamespace(time_s=TIME_S, drive_column=column, conditioned={column: conditioned})


def test_signals_of_a_run_that_is_driven_by_its_place():
    f_in = np.arange(7.0)
    found = signals_of(run_of(), f_in)
    assert found["f_in_N"] is f_in
    np.testing.assert_array_equal(found["time_s"], 0.5 * np.arange(7))
    np.testing.assert_array_equal(found["x_in_mm"], X)
    assert found["speed_mm_per_s"][1] == 3.0  # 3 mm in 1 s
    assert found["speed_mm_per_s"][0] == 2.0
    np.testing.assert_array_equal(
        found["travel_since_reversal_mm"], [0.0, 1.0, 0.0, 1.0, 0.0, 0.5, 1.5]
    )
    np.testing.assert_array_equal(found[DIRECTION], [1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0])


def test_a_force_at_the_drive_has_no_place_and_a_rest_pulls():
    found = signals_of(run_of("f_in_N"), X)
    assert set(found) == {"f_in_N", "time_s", DIRECTION}
    still = signals_of(run_of(reversals=np.array([0, 6]), values=np.ones(7)), X)
    assert set(still[DIRECTION]) == {1.0}
    assert not still["travel_since_reversal_mm"].any()


def test_every_signal_has_its_words():
    for name in signals_of(run_of(), X):
        assert signal_in_words(name) != name
    assert (
        signal_in_words("time_s (f_in_N swings at 3 Hz)")
        == "the time in the run (f_in_N swings at 3 Hz)"
    )
    assert signal_in_words("something") == "something"


def test_bins_hold_equally_many_samples_each_once():
    signal, error = np.arange(24.0) ** 2, np.arange(24.0)
    edges = edges_of(signal, "x_in_mm")
    assert edges.size == 13
    assert (edges[0], edges[-1]) == (0.0, 23.0**2)
    bins = binned(signal, error, edges, "x_in_mm")
    assert sum(b.samples for b in bins) == 24
    assert {b.samples for b in bins} == {2}
    for k, one in enumerate(bins):
        assert (one.low, one.high) == ((2.0 * k) ** 2, (2.0 * k + 1.0) ** 2)
        assert one.mean == 2.0 * k + 0.5
        assert one.sd == 0.5
    assert bins[0].label.startswith("0 to ")


def test_labels_are_bins_of_their_own():
    direction = np.array([1.0, -1.0, -1.0, 1.0, 1.0])
    error = np.array([1.0, 2.0, 4.0, 5.0, 9.0])
    down, up = binned(direction, error, edges_of(direction, DIRECTION), DIRECTION)
    assert (down.label, down.mean, down.samples) == ("releasing", 3.0, 2)
    assert (up.label, up.mean, up.samples) == ("pulling", 5.0, 3)
    number = np.array([1.0, 1.0, 0.0, 1.0, 0.0])
    first, second = binned(number, error, edges_of(number, "run"), "run", ["a", "b"])
    assert (first.label, first.mean) == ("a", 6.5)
    assert (second.label, second.samples) == ("b", 3)


def test_hats_add_up_to_one_for_their_own_direction():
    rng = np.random.default_rng(1)
    signal, direction = rng.standard_normal(200), rng.choice([-1.0, 1.0], 200)
    columns = hats(signal, direction)
    assert columns.shape == (200, 20)
    half = columns[:, :10].sum(axis=1)
    np.testing.assert_allclose(half, direction > 0.0, atol=1e-12)
    np.testing.assert_allclose(columns.sum(axis=1), 1.0)
    # Straight lines between knots: they can draw any line over the signal.
    knots = np.quantile(signal, np.linspace(0.0, 1.0, 10))
    drawn = columns @ np.tile(3.0 * knots - 1.0, 2)
    np.testing.assert_allclose(drawn, 3.0 * signal - 1.0, atol=1e-12)
    assert hats(np.ones(5), np.ones(5)).shape == (5, 0)
    # What is at rest does not pull.
    still = hats(np.arange(20.0), np.zeros(20))
    assert not still[:, :10].any()
    np.testing.assert_allclose(still[:, 10:].sum(axis=1), 1.0)


def test_a_regression_tells_each_fold_by_the_others_alone():
    """Ridge of weight 1: (Σ x² + 1) b = Σ x y over what is not in the fold."""
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([2.0, 3.0, 7.0, 7.5])
    fold = np.array([0, 0, 1, 1])
    found = regressed(x[:, None], y, fold)
    by_second = (3.0 * 7.0 + 4.0 * 7.5) / (9.0 + 16.0 + 1.0)
    by_first = (1.0 * 2.0 + 2.0 * 3.0) / (1.0 + 4.0 + 1.0)
    np.testing.assert_allclose(found, [by_second, 2 * by_second, 3 * by_first, 4 * by_first])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_directions_have_regressions_apart(sign):
    direction = np.tile([1.0, -1.0], 100)
    signal = np.repeat(np.linspace(0.0, 1.0, 100), 2)
    error = 50.0 * sign * direction * signal
    found = regressed(hats(signal, direction), error, np.arange(200) // 2 % 4)
    assert np.mean((found - error) ** 2) < 0.02 * np.mean(error**2)
