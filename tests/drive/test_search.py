"""Which terms a drive has, decision by decision, on squares that are made up."""

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from tests.drive.verdicts import MadeUpSquares, terms
from tsas_cli.drive import search as ds
from tsas_cli.drive.fit import LINEAR
from tsas_cli.drive.harmonic_drive import DriveValues, linear_response
from tsas_cli.drive.runs import DriveRun
from tsas_cli.drive.search import NOTHING, drive_folds
from tsas_cli.numerics.linear_response import sampled


class MadeUp(MadeUpSquares):
    """Notes what is fitted and folded."""

    def __init__(self, squares, default=10.0, *, failed=()):
        super().__init__(squares, default)
        self.failed, self.fitted, self.folded = failed, [], []

    def fold(self, best):
        self.folded.append(best.terms)

    def trial(self, names):
        self.fitted.append(names)
        good = names not in self.failed
        return SimpleNamespace(
            terms=names, solution=SimpleNamespace(converged=good), mean_square=len(self.fitted)
        )

    def trials_of(self, sets):
        return [self.trial(names) for names in sets]


def test_all_sixteen_structures_are_there_the_simplest_first():
    found = ds.structures(terms("play"))
    every = {terms(*c, "play") for n in range(5) for c in combinations(LINEAR, n)}
    assert set(found) == every
    assert len(found) == 16
    assert found[0] == terms("play")
    assert found[-1] == terms(*LINEAR, "play")
    assert set(found[1:4]) == {terms(t, "play") for t in ("lag", "delay", "leak")}  # one number


LAG, DELAY, BOTH = terms("lag"), terms("delay"), terms("lag", "spring")


@pytest.mark.parametrize(
    ("squares", "failed", "taken"),
    [
        ({LAG: 1.02, BOTH: 1.0}, (), LAG),  # the simplest that is not surely beaten
        ({LAG: 1.04, BOTH: 1.0}, (), BOTH),
        ({LAG: 1.0, DELAY: 2.0}, (LAG,), DELAY),  # none that did not converge, where another did
        ({LAG: 1.0}, ds.structures(), LAG),
    ],
)
def test_the_structure_that_is_taken(squares, failed, taken):
    assert ds.chosen(MadeUp(squares, failed=failed), NOTHING) == taken


def test_with_the_gear_the_structure_is_chosen_again():
    """A lag imitates play: with play it is not needed, and the blocks are made anew."""
    squares = {terms("lag"): 4.0, terms("lag", "play"): 1.0, terms("play"): 1.001}
    search = MadeUp(squares)
    assert ds.find_terms(search) == terms("play")
    assert search.folded == [NOTHING, terms("lag", "play")]


def test_rivals_of_a_lag_are_what_explains_as_much_in_its_place():
    squares = {NOTHING: 5.0, terms("lag"): 1.0, terms("delay"): 1.009, terms("play"): 1.011}
    assert ds.rivals(MadeUp(squares), terms("lag"), "lag") == ("delay",)
    closer = MadeUp({NOTHING: 5.0, terms("lag"): 1.0, terms("play"): 1.005})
    assert ds.rivals(closer, terms("lag"), "lag") == ("play",)
    alone = MadeUp({NOTHING: 1.01, terms("lag"): 1.0, terms("delay"): 1.0})
    assert ds.rivals(alone, terms("lag"), "lag") == ()  # no better than nothing


RIPPLE, PLAY, GEAR = terms("ripple"), terms("play"), terms("ripple", "play")


@pytest.mark.parametrize(
    ("squares", "others", "gear"),
    [
        ({NOTHING: 1.149}, 0.5, NOTHING),  # nothing is left
        ({NOTHING: 1.15}, 0.5, RIPPLE),
        ({NOTHING: 4.0}, 3.99, NOTHING),
        ({NOTHING: 4.0, PLAY: 1.0, GEAR: 1.0}, 4.0, PLAY),
        ({NOTHING: 4.0, PLAY: 1.0, GEAR: 1.0, RIPPLE: 3.0}, 4.0, PLAY),  # both convince
        ({NOTHING: 4.0, RIPPLE: 1.0, GEAR: 0.98}, 4.0, RIPPLE),  # both are not surely better
        ({NOTHING: 4.0, RIPPLE: 2.0, GEAR: 1.0}, 4.0, GEAR),
    ],
)
def test_the_gear_is_what_surely_explains_what_is_left(squares, others, gear):
    search = MadeUp(squares, others)
    assert ds._with_gear(search, NOTHING) == gear
    assert (search.fitted == []) == (search.mean_square(NOTHING) < 1.15)


def chirped(kind, size=1000, highest_Hz=20.0):
    t = 0.005 * np.arange(size)
    rate = highest_Hz / t[-1]
    speed = 500.0 * np.sin(2.0 * np.pi * 0.5 * rate * t**2)
    u = sampled(0.005, speed, "first")
    return DriveRun(kind, u, linear_response(u, DriveValues(0.02)), 1e-3, at_rest=True)


@pytest.mark.parametrize(
    ("others", "by_run"),
    [([chirped("b", 1200)], True), ([], False), ([chirped("slow", 1000, 5.0)], False)],
)
def test_what_two_runs_show_is_held_out_run_by_run_else_in_stretches(others, by_run):
    runs = [chirped("a"), *others]
    residuals = [np.random.default_rng(k).standard_normal(r.x_in.size) for k, r in enumerate(runs)]
    folds = drive_folds(runs, residuals)
    assert folds.by_run == by_run
    np.testing.assert_array_equal(folds.fold, folds.run if by_run else folds.block % 4)
    np.testing.assert_array_equal(
        folds.run, np.repeat(np.arange(len(runs)), [r.size for r in residuals])
    )
    assert set(np.diff(folds.block)) == {0, 1}
    assert np.all(np.diff(folds.block)[np.diff(folds.run) > 0] == 1)  # no block is of two runs
    assert 100 <= folds.blocks == folds.block[-1] + 1 <= 220
