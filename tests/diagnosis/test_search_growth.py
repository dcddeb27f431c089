"""How effects are added one after the other, or two at once, on squares that are made up."""

from collections import defaultdict
from itertools import combinations
from operator import attrgetter

import numpy as np
import pytest

from tests.diagnosis.searched import (
    OF,
    A,
    B,
    Bench,
    C,
    D,
    E,
    fits_over,
    names,
    pairs,
    screened,
    search_over,
    tolerances_take,
)
from tsas_cli.diagnosis import search as s

KNOWN = (A, B, C, D, E)


@pytest.fixture
def grown(monkeypatch):
    """A search over given mean squares, 8 where none is given, held out evenly."""
    search_over(monkeypatch)

    def make(mean_squares, **of_bench):
        bench = Bench(defaultdict(lambda: 8.0, mean_squares), **of_bench)
        fits = fits_over(bench, KNOWN)
        everything = [screened(name) for name in KNOWN]
        fits.screen = lambda at: [x for x in everything if x.effect.name not in at]
        return fits

    return make


def test_one_after_the_other_is_added_while_it_convinces(grown):
    found = {names(): 64.0, names(A): 32.0, names(B): 63.0, names(C): 63.5}
    found |= {names(A, B): 12.0, names(A, C): 31.0, names(B, C): 40.0, names(A, B, C): 4.0}
    fits = grown(dict.fromkeys(every(), 70.0) | found)
    assert s.significant_effects(fits) == names(A, B, C)


def every():
    return [names(*c) for n in range(1, 6) for c in combinations((A, B, C, D, E), n)]


def test_it_ends_where_it_is_quiet(grown):
    """With A the model is at the noise: that B would take away more is not asked for."""
    fits = grown({names(): 8.0, names(A): 1.1, names(A, B): 0.5})
    assert s.significant_effects(fits) == names(A)
    assert names(A, B) not in fits.bench.fitted


@pytest.mark.parametrize(("left", "found"), [(0.9, names(A, B)), (1.09, names(A))])
def test_it_goes_on_where_it_is_quiet_by_tolerances(grown, monkeypatch, left, found):
    """More than half of what A leaves is taken for tolerances: B may be there in their place."""
    fits = grown({names(): 8.0, names(A): 1.1, names(A, B): left, names(A, C): 1.09})
    tolerances_take(monkeypatch, 0.51)
    assert s.significant_effects(fits) == found
    assert names(A, B) in fits.bench.fitted


def test_nothing_is_named_where_nothing_convinces(grown):
    fits = grown({names(): 4.0} | dict.fromkeys(every(), 3.95))
    assert s.significant_effects(fits) == names()
    assert s.significant_effects(grown({names(): 1.0} | dict.fromkeys(every(), 0.99))) == names()


def halving(most=5):
    """Each of the effects halves what is left, whatever else is there."""
    return {names(): 640.0} | {n: 640.0 / 4.0 ** len(n) for n in every() if len(n) <= most}


def test_no_more_than_four_are_named(grown):
    assert len(s.significant_effects(grown(halving()))) == 4


def test_where_simple_and_best_differ_both_ways_are_gone(grown):
    """A has fewer parameters than C, which is better but not by three hundredths."""
    assert len(OF[A].parameters) < len(OF[C].parameters)
    low = {names(): 8.0, names(A): 4.02, names(C): 4.0}
    for end, chosen in ((1.0, names(A, B)), (0.9, names(C, D))):
        ends = {names(A, B): 1.0, names(C, D): end}
        fits = grown(dict.fromkeys(every(), 8.0) | low | ends)
        assert s._better(fits, names()) == [names(A), names(C)]
        assert s.significant_effects(fits) == chosen


def test_a_mesh_is_used_for_both_where_one_needs_it(grown):
    fits = grown({names(): 4.0, names(A): 2.0}, mesh=(A,))
    fits.gain(names(), names(A))
    assert [(fit.fitted, fit.on_mesh) for fit in fits.bench.fits] == [
        (names(), True),
        (names(A), True),
    ]
    fits.gain(names(), names(B))
    assert fits.bench.fits[-2].on_mesh is False
    # The fit on the mesh gives the other one its initial values.
    assert fits.bench.fits[-2].near is fits.trials[names(), True]
    assert fits.held_out(names(), on_mesh=True) is fits.squares[names(), True]
    s.matters(fits, names(), {A})
    s.matters(fits, names(B), {A})
    assert all(fit.on_mesh for fit in fits.bench.fits[4:])


def paired(grown, squares, surplus, needed=None):
    """Let pairs of effects explain so much more together than alone."""
    fits = grown(dict.fromkeys(every(), 8.0) | {names(): 8.0} | squares)
    first, second, rest = pairs(3)
    # Two signatures that are nearly one: their difference alone is `second`.
    signatures = {A: first, B: first + 0.05 * second}
    residual = np.sqrt(surplus) * second + np.sqrt(1.0 - surplus) * rest
    fits.trial(names()).solution.residual = residual
    found = [screened(n, 0.0, at[:, None]) for n, at in signatures.items()]
    fits.screen = lambda at: found
    return fits


@pytest.mark.parametrize(
    ("nothing", "surplus", "looked"),
    [
        (1.3, 0.024, False),  # too small a part to tell
        (1.3, 0.026, True),
        # Of 8 − 1 it has to take 0.2 (7 − 0.15), of which 0.4 is 0.0685 of the squares.
        (8.0, 0.067, False),
        (8.0, 0.07, True),
    ],
)
def test_a_pair_has_to_explain_more_than_both_alone(grown, nothing, surplus, looked):
    fits = paired(grown, {names(): nothing, names(A, B): 1.0}, surplus)
    assert (
        s._best_pair(fits, names(), convinces=attrgetter("convincing")) == names(A, B)
    ) == looked
    assert (names(A, B) in fits.bench.fitted) == looked
