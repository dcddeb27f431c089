"""Held-out squares, against fits that really leave a run out."""

import numpy as np
import pytest

from tsas_cli.diagnosis.held_out import folds_of, held_out_squares, held_out_values
from tsas_cli.identification.extension import Trial
from tsas_cli.identification.fit import Solution, Unknown

RUNS, ROWS = 4, 60


def unknown(name, run=None):
    return Unknown(name, run, 0.0, -1e6, 1e6, 1e3)  # a scale so wide that it holds nothing back


@pytest.fixture
def linear():
    """A linear model with two shared unknowns and an offset of each run, fitted to noise."""
    rng = np.random.default_rng(1)
    shared = rng.standard_normal((RUNS * ROWS, 2))
    own = np.kron(np.eye(RUNS), np.ones((ROWS, 1)))
    data = shared @ [1.0, -2.0] + own @ [3.0, 4.0, 5.0, 6.0] + rng.standard_normal(RUNS * ROWS)
    return shared, own, data


def trial_of(J, data, names):
    values = np.linalg.lstsq(J, data, rcond=None)[0]
    solution = Solution(values, np.zeros(values.size, bool), J @ values - data, J, True, "", 1)
    return Trial((), tuple(names), solution, (ROWS,) * RUNS, on_mesh=False)


def blocks(count=6):
    return [np.arange(ROWS) * count // ROWS for _ in range(RUNS)]


def test_a_run_is_predicted_by_the_fit_to_the_others_its_own_offset_fitted_to_it(linear):
    shared, own, data = linear
    names = [unknown("a"), unknown("b"), *(unknown("zero", k) for k in range(RUNS))]
    trial = trial_of(np.hstack((shared, own)), data, names)
    folds = folds_of(blocks())
    assert folds.by_run
    left = folds.fold == 2
    others = np.linalg.lstsq(np.hstack((shared, own))[~left], data[~left], rcond=None)[0][:2]
    error = shared[left] @ others - data[left]
    error -= error.mean()
    found = held_out_squares(trial, folds)[folds.block[left].min() : folds.block[left].max() + 1]
    np.testing.assert_allclose(found, (error**2).reshape(6, -1).sum(axis=1), rtol=1e-6)
    np.testing.assert_allclose(held_out_values(trial, folds, 2)[:2], others, rtol=1e-6)


def test_an_unknown_that_only_helps_its_own_run_gains_nothing_on_others(linear):
    """A column that is noise fits better, and predicts worse."""
    shared, own, data = linear
    rng = np.random.default_rng(2)
    junk = rng.standard_normal((RUNS * ROWS, 8))
    names = [unknown("a"), unknown("b"), *(unknown("zero", k) for k in range(RUNS))]
    plain = trial_of(np.hstack((shared, own)), data, names)
    more = [*names, *(unknown(f"junk{i}") for i in range(8))]
    rich = trial_of(np.hstack((shared, own, junk)), data, more)
    folds = folds_of(blocks())
    assert rich.mean_square < plain.mean_square
    assert held_out_squares(rich, folds).sum() > held_out_squares(plain, folds).sum()


def test_few_runs_are_held_out_in_stretches():
    folds = folds_of(blocks()[:2])
    assert not folds.by_run
    assert folds.blocks == 12
    assert np.unique(folds.fold[folds.run == 0]).size == 4
    assert not np.intersect1d(folds.fold[folds.run == 0], folds.fold[folds.run == 1]).size
    for block in range(12):  # a block is never cut
        assert np.unique(folds.fold[folds.block == block]).size == 1


def test_values_move_as_in_a_refit_where_the_residuals_change(linear):
    shared, own, data = linear
    J = np.hstack((shared, own))
    names = [unknown("a"), unknown("b"), *(unknown("zero", k) for k in range(RUNS))]
    trial = trial_of(J, data, names)
    changes = np.random.default_rng(3).standard_normal((data.size, 2))
    moved = trial.moved_by(changes)
    for k in range(2):
        refitted = np.linalg.lstsq(J, data - changes[:, k], rcond=None)[0]
        np.testing.assert_allclose(moved[:, k], refitted - trial.solution.values, rtol=1e-6)
