"""Decisions of a search: what is fitted, what matters, what is left out, rivals and pairs."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.made_up import (
    BLOCKS,
    OF,
    SIZE,
    Bench,
    evenly,
    names,
    screened,
    search_over,
    without_tolerances,
)
from tsas_cli.diagnosis import search as s
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.rivals import exchanged, rivals_of

A, B, C = "backlash", "free_tendon", "load_friction"
CONVINCES, DOES_NOT = Reduction(0.5, 4.0), Reduction(0.5, 1.0)


@pytest.fixture
def made(monkeypatch):
    """A search over given mean squares; a trial's held-out squares are spread evenly."""
    monkeypatch.setattr(s, "held_out_squares", evenly)
    without_tolerances(monkeypatch)
    return lambda mean_squares: search_over(Bench(mean_squares), (A, B, C))


@pytest.mark.parametrize(("left", "quiet"), [(1.149, True), (1.151, False)])
def test_it_is_quiet_where_the_blur_of_a_right_model_begins(made, left, quiet):
    search = made({names(A): left})
    search.is_complete = lambda names: False
    assert search.is_quiet(names(A)) == quiet


@pytest.mark.parametrize(("left", "quiet"), [(2.9, True), (3.1, False)])
def test_slow_noise_is_quiet_too_up_to_its_limit(made, left, quiet):
    search = made({names(A): left})
    search.is_complete = lambda names: True
    assert search.is_quiet(names(A)) == quiet


@pytest.mark.parametrize(
    ("nothing", "one", "two", "matters"),
    [
        # A first cause: more than 0.2 of what is beyond noise and blur, 0.2 (2.15 − 1 − 0.15).
        (2.15, 1.951, None, False),
        (2.15, 1.949, None, True),
        # A further one: more than 0.2 of what the first left beyond the noise.
        (9.0, 2.0, 1.801, False),
        (9.0, 2.0, 1.799, True),
        # And more than 0.003 of what there was before any.
        (501.0, 4.0, 2.501, False),
        (501.0, 4.0, 2.499, True),
    ],
)
def test_a_cause_matters_by_its_share(made, nothing, one, two, matters):
    search = made({names(): nothing, names(A): one, names(A, B): two})
    if two is None:
        assert search.matters(names(), {A}) == matters
    else:
        assert search.matters(names(A), {B}) == matters


def test_gains_are_those_of_the_squares(made):
    search = made({names(): 4.0, names(A): 1.0})
    found = search.gain(names(), names(A))
    assert found.part == pytest.approx(0.75)
    assert found.test_statistic == pytest.approx(
        np.sqrt(1.5 * BLOCKS * (BLOCKS + 1) / (2 * BLOCKS + 1))
    )
    assert search.gain(names(A), names()).part == pytest.approx(-3.0)


@pytest.mark.parametrize(("in_line", "part"), [(False, 0.75), (True, 0.5)])
def test_gains_are_beside_the_friction_of_each_run_unless_it_changes_with_the_session(
    made, monkeypatch, in_line, part
):
    """Own frictions leave half of what the effect leaves, and all that none leaves."""
    halved = {2.0: 1.0, 4.0: 4.0}
    monkeypatch.setattr(
        s,
        "with_friction_of_runs",
        lambda trial, run: SimpleNamespace(mean_square=halved[trial.mean_square]),
    )
    monkeypatch.setattr(s, "is_in_line", lambda trial, run, session_s: in_line)
    search = made({names(): 4.0, names(A): 2.0})
    assert search.gain(names(), names(A)).part == pytest.approx(part)


def seen(search, at, *parts, signatures=None):
    search.screened[at] = [
        screened(name, part, None if signatures is None else signatures[name])
        for name, part in parts
    ]


def test_only_what_is_seen_beside_the_best_is_fitted_the_best_gain_first(made):
    search = made({names(): 4.0, names(A): 3.0, names(B): 2.0, names(C): 1.0})
    seen(search, names(), (A, 0.5), (B, 0.11), (C, 0.09))  # a fifth of the best is 0.1
    assert [name for name, _ in search.add(names())] == [B, A]
    assert names(C) not in search.bench.fitted


@pytest.mark.parametrize(("least", "found"), [(0.99, [B, A]), (1.01, [A])])
def test_what_cannot_reduce_the_squares_enough_is_not_fitted(made, least, found):
    """Of 4.0, 0.4 of a reduction by one is a tenth."""
    search = made({names(): 4.0, names(A): 3.0, names(B): 2.0})
    seen(search, names(), (A, 0.4), (B, 0.1))
    assert [name for name, _ in search.add(names(), least)] == found


def test_a_fit_that_is_worse_with_more_freedom_starts_again_closer(made):
    parameter = OF[B].parameters[0]
    start = {f"{B}.{parameter.name}": parameter.neutral + 1.0}
    search = made({names(): 4.0, names(B): [9.0, 5.0, 3.0]})
    search._fit(names(), names(B), start)
    starts = [fit.start for fit in search.bench.fits if fit.fitted == names(B)]
    away = [next(iter(at.values())) - parameter.neutral for at in starts]
    assert away == pytest.approx([1.0, 0.2, 0.04])
    assert search.trial(names(B)).mean_square == 3.0


def test_rivals_convince_too_and_are_not_surely_worse(made):
    search = made({names(B): 1.001, names(C): 1.001, names(A): 1.0, names(): 4.0})
    search.add = lambda *_: [(A, CONVINCES), (B, CONVINCES), (C, DOES_NOT)]
    assert rivals_of(search, names(A), A) == (B,)  # itself is none, and C convinces nobody
    worse = made({names(B): 1.02, names(A): 1.0, names(): 4.0})
    worse.add = lambda *_: [(B, CONVINCES)]
    assert rivals_of(worse, names(A), A) == ()
    search.trial(names(B)).solution.converged = False
    assert rivals_of(search, names(A), A) == ()


@pytest.mark.parametrize(("part", "rivals"), [(0.29, ()), (0.31, (B,))])
def test_what_cannot_take_away_as_much_is_no_rival(made, part, rivals):
    """Of 4.0 the named one takes 3.0 away; 0.4 of that is 0.3 of the squares."""
    search = made({names(): 4.0, names(A): 1.0, names(B): 1.0})
    seen(search, names(), (A, 0.75), (B, part))
    assert rivals_of(search, names(A), A) == rivals


@pytest.mark.parametrize(("unsure", "rivals"), [(0.0, ()), (0.025, ()), (0.035, (B,))])
def test_an_effect_that_leaves_a_little_more_of_a_wrong_model_is_a_rival(made, unsure, rivals):
    """4 % more: beyond the one per cent that tells right models apart."""
    search = made({names(): 9.0, names(A): 4.8, names(B): 5.0})
    search.add = lambda before, least=0.0: [(B, CONVINCES)]
    assert rivals_of(search, names(A), A, unsure) == rivals


def test_what_the_others_do_not_need_is_left_out_but_never_the_last(made):
    """One after the other, in the order of their names."""
    squares = {names(A, B, C): 1.0, names(B, C): 1.01, names(C): 1.02, names(B): 2.0}
    squares |= {names(A, C): 1.5, names(A, B): 3.0, names(): 1.02}
    assert made(squares)._without_redundant(names(A, B, C)) == names(C)
    needed = {k: (1.0 if k == names(A, B, C) else 9.0) for k in squares}
    assert made(needed)._without_redundant(names(A, B, C)) == names(A, B, C)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_two_that_hide_each_other_are_found_together(made, sign):
    """Each takes next to nothing away alone: they are two sides of nearly the same signature."""
    rng = np.random.default_rng(3)
    common, apart, other = np.linalg.qr(rng.standard_normal((SIZE, 3)))[0].T
    signatures = {
        A: common[:, None],
        B: (common + 0.1 * apart)[:, None],
        C: other[:, None],
    }
    search = made({names(): 4.0, names(A, B): 1.0, names(B): 3.95})
    search.trial(names()).solution.residual = sign * apart
    seen(search, names(), (A, 0.0), (B, 0.01), (C, 0.0), signatures=signatures)
    assert search._best_pair(names()) == names(A, B)
    assert set(search.bench.fitted) == {names(), names(A, B)}
    assert search._better(names()) == [names(A, B)]


@pytest.mark.parametrize("squares", [3.99, 3.5])
def test_a_pair_has_to_convince_and_to_matter(made, squares):
    rng = np.random.default_rng(3)
    common, apart = np.linalg.qr(rng.standard_normal((SIZE, 2)))[0].T
    signatures = {A: common[:, None], B: (common + 0.1 * apart)[:, None]}
    search = made({names(): 4.0, names(A, B): squares, names(B): 3.99})
    search.trial(names()).solution.residual = apart
    seen(search, names(), (A, 0.0), (B, 0.01), signatures=signatures)
    assert search._best_pair(names()) is None
    assert search._better(names()) == []


def test_a_rival_that_is_better_beside_the_others_takes_the_place_of_a_named_effect(made):
    """Found first, B is worse than C once A is there; alone, it is better."""
    alone = {names(): 9.0, names(A): 5.0, names(B): 3.0, names(C): 4.0}
    search = made(alone | {names(A, B): 1.2, names(A, C): 1.0, names(B, C): 2.9})
    search.add = lambda *_: [(A, CONVINCES), (B, CONVINCES), (C, CONVINCES)]
    assert exchanged(search, names(A, B)) == names(A, C)
    assert exchanged(search, names(A, C)) == names(A, C)


def test_of_two_that_do_as_well_the_one_with_fewer_parameters_is_named(made):
    """A size at its bound does not count, a shape does."""
    search = made({names(): 9.0, names(A): 1.0, names(B): 1.0, names(C): 1.5})
    search.add = lambda *_: [(A, CONVINCES), (B, CONVINCES), (C, CONVINCES)]
    assert exchanged(search, names(A)) == names(A)
    assert exchanged(search, names(B)) == names(B)
    for name, at_bound in ((A, [False]), (B, [True, False])):
        fit = search.trial(names(name))
        fit.unknowns = [SimpleNamespace(name=f"{name}.{p.name}") for p in OF[name].parameters]
        fit.solution.at_bound = at_bound
    assert exchanged(search, names(B)) == names(B)
    search.trial(names(B)).solution.at_bound = [False, False]
    assert exchanged(search, names(B)) == names(A)
