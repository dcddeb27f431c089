"""Held-out squares, against fits that really leave a run out."""

from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.diagnosis.held_out import folds_of, held_out_squares, held_out_values, predicted_folds
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.hypothesis_fit import HypothesisFit

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
    sizes = (ROWS,) * (data.size // ROWS)
    return HypothesisFit((), tuple(names), solution, sizes, on_mesh=False)


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
    np.testing.assert_allclose(held_out_values(trial, folds, 2)[:2], others, rtol=1e-6)


def test_of_many_runs_several_are_predicted_together_each_with_its_own_offset():
    """Eleven runs of one line, each with an offset that the fit to the others leaves alone."""
    runs, rng = 11, np.random.default_rng(2)
    folds = folds_of([np.arange(ROWS) // 10 for _ in range(runs)])
    assert folds.by_run
    assert folds.blocks == runs * 6
    of_fold = [set(folds.run[folds.fold == fold].tolist()) for fold in range(8)]
    assert sorted(map(len, of_fold)) == [1] * 5 + [2] * 3
    assert set.union(*of_fold) == set(range(runs))
    shared = rng.standard_normal((runs * ROWS, 1))
    own, offsets = np.kron(np.eye(runs), np.ones((ROWS, 1))), np.arange(runs, dtype=float)
    data = shared @ [2.0] + own @ offsets + 0.01 * rng.standard_normal(runs * ROWS)
    names = [unknown("a"), *(unknown("zero", k) for k in range(runs))]
    J = np.hstack((shared, own))
    fold = int(folds.fold[folds.run == 9][0])
    left, mine = folds.fold == fold, of_fold[fold]
    found = held_out_values(trial_of(J, data, names), folds, fold)
    others = J[~left][:, [0, *(1 + k for k in range(runs) if k not in mine)]]
    slope = np.linalg.lstsq(others, data[~left], rcond=None)[0][0]
    assert found[0] == pytest.approx(slope, rel=1e-6)
    for k in mine:
        here = folds.run == k
        assert found[1 + k] == pytest.approx(float(np.mean(data[here] - slope * shared[here, 0])))


def test_the_squares_of_a_run_are_those_of_its_prediction_by_the_others(linear):
    """Against the density of the run's data itself, with the covariance of its prediction."""
    shared, own, data = linear
    names = [unknown("a"), unknown("b"), *(unknown("zero", k) for k in range(RUNS))]
    trial = trial_of(np.hstack((shared, own)), data, names)
    folds = folds_of(blocks())
    left = folds.fold == 2
    rest = np.hstack((shared, np.delete(own, 2, axis=1)))[~left]
    fitted = np.linalg.lstsq(rest, data[~left], rcond=None)[0][:2]
    covariance = np.linalg.inv(rest.T @ rest)[:2, :2]
    # Its zero is fitted to the run itself: only what differs from its mean is predicted.
    centred = shared[left] - shared[left].mean(axis=0)
    error = centred @ fitted - (data[left] - data[left].mean())
    whole = np.eye(ROWS) + centred @ covariance @ centred.T
    expected = error @ np.linalg.solve(whole, error)
    in_run = held_out_squares(trial, folds)[np.unique(folds.block[left])]
    uncentred = np.eye(2) + covariance @ shared[left].T @ shared[left]
    assert in_run.sum() == pytest.approx(expected + np.linalg.slogdet(uncentred)[1], rel=1e-6)


def test_what_a_run_alone_determines_is_no_error_of_its_prediction():
    """Two parameters that only the last run tells apart, and one that it contradicts."""
    rng = np.random.default_rng(4)
    a = rng.standard_normal(RUNS * ROWS)
    last = np.arange(RUNS * ROWS) >= 3 * ROWS
    b = np.where(last, rng.standard_normal(RUNS * ROWS), a + 1e-3 * rng.standard_normal(a.size))
    noise = rng.standard_normal(a.size)
    folds = folds_of(blocks())
    both = trial_of(np.column_stack((a, b)), a - b + noise, [unknown("a"), unknown("b")])
    squares = held_out_squares(both, folds)[folds.block[-1] - 5 :]
    assert squares.sum() == pytest.approx(ROWS, rel=0.4)
    assert not predicted_folds(both, folds).by_run
    one = trial_of(a[:, None], np.where(last, 3.0, 1.0) * a + noise, [unknown("a")])
    assert held_out_squares(one, folds)[folds.block[-1] - 5 :].sum() > 3.0 * ROWS
    assert predicted_folds(one, folds).by_run


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


def single(J, residual, unknowns, at_bound=None):
    """Return a trial at values of 0 with a given residual."""
    at_bound = np.zeros(len(unknowns), bool) if at_bound is None else np.array(at_bound)
    values = np.zeros(len(unknowns))
    solution = Solution(values, at_bound, np.array(residual), np.array(J), True, "", 1)
    return HypothesisFit((), tuple(unknowns), solution, (len(residual),), on_mesh=False)


THREE = [np.array([0, 1]), np.array([0, 0]), np.array([0, 1])]


def test_blocks_are_counted_on_and_three_runs_are_enough():
    folds = folds_of(THREE)
    assert folds.by_run
    assert folds.block.tolist() == [0, 1, 2, 2, 3, 4]
    assert folds.fold.tolist() == folds.run.tolist() == [0, 0, 1, 1, 2, 2]
    assert folds.blocks == 5
    two = folds_of([np.arange(8), np.arange(3)])
    assert two.fold.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 5, 6]


def test_the_step_of_one_unknown_by_hand():
    """Without the last run −Σ J r/(Σ J² + 1/scale²): what nobody tells stays."""
    J = [[1.0], [2.0], [3.0], [4.0], [5.0], [6.0]]
    residual = [1.0, -1.0, 2.0, 1.0, 7.0, 7.0]
    trial = single(J, residual, [Unknown("a", None, 0.0, -9.0, 9.0, 0.5)])
    step = -(1.0 - 2.0 + 6.0 + 4.0) / (1.0 + 4.0 + 9.0 + 16.0 + 4.0)
    assert held_out_values(trial, folds_of(THREE), 2) == pytest.approx([step])
    squares = held_out_squares(trial, folds_of(THREE))
    whole = -(9.0 + 35.0 + 42.0) / (34.0 + 25.0 + 36.0)
    of_others = [2.0 * a * 9.0 + a**2 * 34.0 for a in (whole, step)]
    cost = of_others[0] - of_others[1] + np.log(1.0 + (25.0 + 36.0) / 34.0)
    expected = [(7.0 + J * whole) ** 2 + cost * J**2 / 61.0 for J in (5.0, 6.0)]
    assert squares[3:] == pytest.approx(expected)


def test_where_one_of_two_that_do_the_same_reaches_its_bound_the_other_does_the_rest():
    """Both have to fall by 3 together, the first by 0.1 at most."""
    J = np.ones((6, 2)) + 1e-6 * np.random.default_rng(1).standard_normal((6, 2))
    tight = [Unknown("a", None, 0.0, -0.1, 0.1, 1e6), Unknown("b", None, 0.0, -9.0, 9.0, 1e6)]
    found = held_out_values(single(J, np.full(6, 3.0), tight), folds_of(THREE), 0)
    assert abs(found[0]) == pytest.approx(0.1)
    assert found.sum() == pytest.approx(-3.0, rel=1e-4)


def test_values_stay_within_their_bounds_and_at_them():
    J = np.column_stack((np.ones(6), np.arange(6.0)))
    residual = np.full(6, 5.0)
    tight = [Unknown("a", None, 0.0, -0.1, 0.1, 1e3), unknown("b")]
    found = held_out_values(single(J, residual, tight), folds_of(THREE), 0)
    assert found[0] == pytest.approx(-0.1)
    up = held_out_values(single(J, -residual, tight), folds_of(THREE), 0)
    assert up[0] == pytest.approx(0.1)
    bound = single(J, residual, [unknown("a"), unknown("b")], [True, False])
    held = held_out_values(bound, folds_of(THREE), 0)
    k = np.arange(2.0, 6.0)
    assert held == pytest.approx([0.0, -5.0 * k.sum() / (k @ k)], rel=1e-5)


def test_what_belongs_to_one_run_stays_in_stretches_of_it():
    """With two runs a zero is told by the rest of its run, not by what is left out."""
    zero = single(np.ones((8, 1)), [1.0] * 7 + [9.0], [unknown("zero", 0)])
    folds = folds_of([np.array([0, 0, 1, 1, 2, 2, 3, 3])])
    assert held_out_values(zero, folds, 3) == pytest.approx([-1.0], rel=1e-5)
    assert held_out_values(zero, folds, 0) == pytest.approx([-14.0 / 6.0], rel=1e-5)


def test_the_first_run_has_zeros_of_its_own_too():
    J = np.kron(np.eye(3), np.ones((2, 1)))
    residual = [2.0, 4.0, 1.0, 1.0, 0.0, 0.0]
    trial = single(J, residual, [unknown("zero", k) for k in range(3)])
    found = held_out_values(trial, folds_of(THREE), 0)
    assert found == pytest.approx([-3.0, -1.0, 0.0], abs=1e-5)
    fitted = single(J, [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0], [unknown("zero", k) for k in range(3)])
    assert held_out_squares(fitted, folds_of(THREE))[:2] == pytest.approx([1.0, 1.0])


def test_a_fit_ready_for_a_change_is_the_least_squares_beside_it_within_the_bounds(linear):
    shared, own, data = linear
    J = np.hstack((shared, own))
    names = [unknown("a"), unknown("b"), *(unknown("zero", k) for k in range(RUNS))]
    trial = trial_of(J, data, names)
    change = np.random.default_rng(3).standard_normal(data.size)
    ready = trial.ready_for(change)
    expected = np.linalg.lstsq(J, data - change, rcond=None)[0]
    np.testing.assert_allclose(ready.solution.values, expected, rtol=1e-6)
    low = float(trial.solution.values[1])
    bounded = replace(
        trial, unknowns=(names[0], replace(names[1], lower=low, upper=low), *names[2:])
    )
    assert bounded.ready_for(change).solution.values[1] == low


def test_slopes_that_differ_in_the_run_alone_make_its_prediction_uncertain(linear):
    """Two unknowns do the same in all other runs, where rounding hides what separates them."""
    x, folds = linear[0][:, :1], folds_of(blocks())

    def squares(steepness):
        J = steepness * np.hstack((x, x))
        J[:ROWS, 1] *= 0.5
        trial = single(J, np.zeros(len(J)), [unknown("a"), unknown("b")])
        return float(held_out_squares(trial, folds)[:6].sum())

    own, others, weak = float(np.sum(x[:ROWS] ** 2)), float(np.sum(x[ROWS:] ** 2)), 1e-6
    without = (2.0 * others + weak) * weak
    together = own * others / 4.0 + weak * (2.0 * others + 1.25 * own) + weak**2
    assert squares(1.0) == pytest.approx(np.log(together / without), rel=1e-6)
    assert squares(1.0) < squares(1e10) < np.inf
