"""How a search grows, goes back and ends, on fits and squares that are made up."""

from collections import defaultdict
from itertools import combinations

import numpy as np
import pytest

from tests.diagnosis.made_up import (
    OF,
    SIZE,
    Bench,
    evenly,
    names,
    screened,
    search_over,
    without_tolerances,
)
from tsas_cli.diagnosis import hypotheses, search

A, B, C, D, E = "backlash", "drive_friction", "free_tendon", "load_friction", "load_inertia"
KNOWN = (A, B, C, D, E)


def reweighed(bench, trial):
    assert trial.weighed == bench.weighed
    return Bench(bench.mean_squares, bench.mesh, bench.weighed + 1)


@pytest.fixture
def made(monkeypatch):
    """A search over given mean squares, 8 where none is given, held out evenly."""
    monkeypatch.setattr(hypotheses, "reweighted_bench", reweighed)
    monkeypatch.setattr(search, "held_out_squares", evenly)
    without_tolerances(monkeypatch)

    def make(mean_squares, *, step=None, **of_bench):
        bench = Bench(defaultdict(lambda: 8.0, mean_squares), **of_bench)
        search = search_over(bench, KNOWN, *([step] if step else []))
        everything = [screened(name) for name in KNOWN]
        search.screen = lambda at: [x for x in everything if x.effect.name not in at]
        return search

    return make


def test_one_after_the_other_is_added_while_it_convinces(made):
    found = {names(): 64.0, names(A): 32.0, names(B): 63.0, names(C): 63.5}
    found |= {names(A, B): 12.0, names(A, C): 31.0, names(B, C): 40.0, names(A, B, C): 4.0}
    search = made(dict.fromkeys(every(), 70.0) | found)
    assert search.run() == names(A, B, C)


def every():
    return [names(*c) for n in range(1, 6) for c in combinations((A, B, C, D, E), n)]


def test_it_ends_where_it_is_quiet(made):
    """With A the model is at the noise: that B would take away more is not asked for."""
    search = made({names(): 8.0, names(A): 1.1, names(A, B): 0.5})
    assert search.run() == names(A)
    assert names(A, B) not in search.bench.fitted


def test_nothing_is_named_where_nothing_convinces(made):
    search = made({names(): 4.0} | dict.fromkeys(every(), 3.95))
    assert search.run() == names()
    assert made({names(): 1.0} | dict.fromkeys(every(), 0.99)).run() == names()


def halving(most=5):
    """Each of the effects halves what is left, whatever else is there."""
    return {names(): 640.0} | {n: 640.0 / 4.0 ** len(n) for n in every() if len(n) <= most}


def test_no_more_than_four_are_named(made):
    assert len(made(halving()).run()) == 4


def test_where_simple_and_best_differ_both_ways_are_gone(made):
    """A has fewer parameters than C, which is better but not by three hundredths."""
    assert len(OF[A].parameters) < len(OF[C].parameters)
    low = {names(): 8.0, names(A): 4.02, names(C): 4.0}
    for end, chosen in ((1.0, names(A, B)), (0.9, names(C, D))):
        ends = {names(A, B): 1.0, names(C, D): end}
        search = made(dict.fromkeys(every(), 8.0) | low | ends)
        assert search._better(names()) == [names(A), names(C)]
        assert search.run() == chosen


def test_a_mesh_is_used_for_both_where_one_needs_it(made):
    search = made({names(): 4.0, names(A): 2.0}, mesh=(A,))
    search.gain(names(), names(A))
    assert [(fit.fitted, fit.on_mesh) for fit in search.bench.fits] == [
        (names(), True),
        (names(A), True),
    ]
    search.gain(names(), names(B))
    assert search.bench.fits[-2].on_mesh is False
    # The fit on the mesh gives the other one its initial values.
    assert search.bench.fits[-2].near is search.trials[names(), True]
    assert search.held_out(names(), on_mesh=True) is search.squares[names(), True]
    search.matters(names(), {A})
    search.matters(names(B), {A})
    assert all(fit.on_mesh for fit in search.bench.fits[4:])


def pairs(count):
    """Return orthogonal directions, so that each pair's part is what it is given."""
    return np.linalg.qr(np.random.default_rng(1).standard_normal((SIZE, count)))[0].T


def paired(made, squares, surplus, needed=None):
    """Let pairs of effects explain so much more together than alone."""
    search = made(dict.fromkeys(every(), 8.0) | {names(): 8.0} | squares)
    first, second, rest = pairs(3)
    # Two signatures that are nearly one: their difference alone is `second`.
    signatures = {A: first, B: first + 0.05 * second}
    residual = np.sqrt(surplus) * second + np.sqrt(1.0 - surplus) * rest
    search.trial(names()).solution.residual = residual
    found = [screened(n, 0.0, at[:, None]) for n, at in signatures.items()]
    search.screen = lambda at: found
    return search


@pytest.mark.parametrize(("surplus", "looked"), [(0.024, False), (0.026, True)])
def test_a_pair_has_to_explain_a_telling_part_more_than_both_alone(made, surplus, looked):
    search = paired(made, {names(): 1.3, names(A, B): 1.0}, surplus)
    assert (search._best_pair(names()) == names(A, B)) == looked
    assert (names(A, B) in search.bench.fitted) == looked


@pytest.mark.parametrize(("part", "looked"), [(0.067, False), (0.07, True)])
def test_a_pair_has_to_promise_a_sufficient_reduction(made, part, looked):
    """Of 8 − 1 it has to take 0.2 (7 − 0.15), of which 0.4 is 0.0685 of the squares."""
    search = paired(made, {names(A, B): 1.0}, part)
    assert (search._best_pair(names()) == names(A, B)) == looked
