"""What an error is held against: signals and hats; by hand, on a few samples."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.regression import hats, regressed
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


def test_samples_before_the_first_and_after_the_last_reversal():
    """They belong to the first and to the last stroke."""
    x = np.array([2.0, 1.0, 0.0, 1.0, 3.0, 2.5, 2.0])
    found = signals_of(run_of(reversals=np.array([2, 4]), values=x), x)
    np.testing.assert_array_equal(
        found["travel_since_reversal_mm"], [2.0, 1.0, 0.0, 1.0, 3.0, 2.5, 2.0]
    )
    np.testing.assert_array_equal(found[DIRECTION], 1.0)
    alone = signals_of(run_of(reversals=np.array([3, 5, 6]), values=x), x)
    np.testing.assert_array_equal(
        alone["travel_since_reversal_mm"], np.abs(x - np.array([1.0, 1, 1, 1, 1, 2.5, 2.5]))
    )
    np.testing.assert_array_equal(alone[DIRECTION], [1.0, 1, 1, 1, 1, 1, -1])


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
