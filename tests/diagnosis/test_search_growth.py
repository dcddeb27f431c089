"""How a search grows, goes back and ends, on fits and squares that are made up."""

from collections import defaultdict
from itertools import combinations

import numpy as np
import pytest

from tests.counted import Counted
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
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.identification import screening

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


def test_a_pair_is_looked_at_while_there_is_room_for_two(made):
    asked = []
    for count, looked in ((0, True), (2, True), (3, False)):
        search = made({})
        search.add = lambda *_: []
        search._best_pair = asked.append
        before = len(asked)
        assert search._better(names(*(A, B, C)[:count])) == []
        assert (len(asked) > before) == looked


def test_where_simple_and_best_differ_both_ways_are_gone(made):
    """A has fewer parameters than C, which is better but not by three hundredths."""
    assert len(OF[A].parameters) < len(OF[C].parameters)
    low = {names(): 8.0, names(A): 4.02, names(C): 4.0}
    for end, chosen in ((1.0, names(A, B)), (0.9, names(C, D))):
        ends = {names(A, B): 1.0, names(C, D): end}
        search = made(dict.fromkeys(every(), 8.0) | low | ends)
        assert search._better(names()) == [names(A), names(C)]
        assert search.run() == chosen


def test_a_set_that_was_passed_is_not_gone_through_again(made):
    search = made(halving())
    search._better = lambda at: [names(A)]
    assert search._grown(names(A), frozenset()) == names(A)


def test_the_best_of_the_simple_ones_stands_for_itself(made):
    """What has as many parameters as the best one is no simpler."""
    convinces = Reduction(0.5, 4.0)
    assert len(OF[A].parameters) == len(OF[B].parameters)
    search = made({names(A): 1.0, names(B): 1.0})
    assert search._simplest(names(), [(B, convinces), (A, convinces)]) == B


def test_a_single_effect_has_to_matter(made):
    """Of 9 − 1 it takes away 0.2 (8 − 0.15) or less: it convinces and does not matter."""
    search = made({names(): 9.0, names(A): 7.5} | dict.fromkeys(every()[1:], 9.0))
    search._best_pair = lambda at: None
    assert search._better(names()) == []
    search = made({names(): 9.0, names(A): 5.8} | dict.fromkeys(every()[1:], 9.0))
    assert search._better(names()) == [names(A)]


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


def test_what_is_new_lies_ahead_and_is_done(made):
    counted = Counted()
    search = made({names(): 4.0} | dict.fromkeys(every(), 3.9), step=counted)
    search.trial(names())
    assert len(search.add(names())) == 5
    assert counted.total == counted.done == 5
    search.add(names())
    assert counted.total == counted.done == 5  # all are known


def test_all_further_effects_are_screened_once(made, monkeypatch):
    counted = Counted()
    search = made({}, step=counted, mesh=(E,))
    del search.screen  # the given one
    looked = []

    def screen(bench, trial, effect, basis):
        looked.append((effect.name, trial.on_mesh, basis))
        return screened(effect.name, part=0.1 * len(looked))

    monkeypatch.setattr(screening, "projector", lambda trial: ("basis", trial.on_mesh))
    monkeypatch.setattr(screening, "screen", screen)
    found = search.screen(names(A))
    assert [x.effect.name for x in found] == [name for name in KNOWN if name != A][::-1]
    assert {(n, mesh, basis) for n, mesh, basis in looked} == {
        (n, n == E, ("basis", n == E)) for n in (B, C, D, E)
    }
    assert counted.total == counted.done == 4
    assert search.screen(names(A)) is found
    assert len(looked) == 4


def test_errors_are_weighed_three_times_by_what_was_found(made):
    counted = Counted()
    search = made({}, mesh=(B,))
    sets = {names(), names(A), names(B), names(A, B)}
    trials = {(n, True): search.trial(n, on_mesh=True) for n in sets}
    found = Hypotheses(search.bench, search.folds, names(A, B), {A: (C,)}, (), trials, {})
    other = hypotheses.reweighted_hypotheses(found, counted)
    assert (other.bench.weighed, found.bench.weighed) == (3, 0)
    assert (other.named, other.rivals) == (found.named, found.rivals)
    assert set(other.trials) == {(n, True) for n in sets}
    assert {trial.weighed for trial in other.trials.values()} == {3}
    assert not other.squares
    assert counted.total == counted.done == 3 + 4
    near = {fit.fitted: fit.near for fit in other.bench.fits}
    assert all(near[n] is search.trial(n, on_mesh=True) for n in sets - {names(A, B)})


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


def test_parts_of_each_alone_are_taken_off(made):
    search = paired(made, {names(A, B): 1.0}, 0.05)
    alone = [screened(x.effect.name, 0.015, x.signatures) for x in search.screen(names())]
    search.screen = lambda at: alone
    assert search._best_pair(names()) is None  # 0.05 − 2 · 0.015


def test_what_a_pair_takes_away_lies_ahead(made):
    search = paired(made, {names(A, B): 1.0}, 0.5)
    search.step = counted = Counted()
    search._best_pair(names())
    assert counted.total == counted.done == 1
    search._best_pair(names())
    assert counted.total == counted.done == 1


def test_four_pairs_are_fitted_at_the_most_the_most_promising_first(made):
    """Five signatures that are nearly one make ten pairs, none of which convinces."""
    search = made(dict.fromkeys([*every(), names()], 1.3))
    common, *apart = pairs(6)
    search.trial(names()).solution.residual = sum(
        (k + 1.0) * at for k, at in enumerate(apart)
    ) / np.sqrt(55.0)
    found = [
        screened(n, 0.0, (common + 0.05 * at)[:, None])
        for n, at in zip((A, B, C, D, E), apart, strict=True)
    ]
    search.screen = lambda at: found
    assert search._best_pair(names()) is None
    fitted = [found for found in search.bench.fitted if len(found) == 2]
    # Of (k a_k − l a_l)/√2 the largest: 5 and 1 of opposite direction are 4²/2, then 3²/2.
    assert len(fitted) == 4
    assert fitted[0] == names(A, E)
    assert set(fitted[1:3]) == {names(A, D), names(B, E)}


def test_a_start_is_that_of_both(made):
    search = paired(made, {names(A, B): 1.0}, 0.5)
    search._best_pair(names())
    assert set(search.bench.fits[-1].start) == {f"{n}.{OF[n].parameters[0].name}" for n in (A, B)}
