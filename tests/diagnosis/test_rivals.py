"""What is as good as a named effect, on fits and squares that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.searched import (
    ALL_CONVINCE,
    BLOCKS,
    CONVINCES,
    DOES_NOT,
    OF,
    SIZE,
    A,
    C,
    D,
    names,
    search_over,
    seen,
    tolerances_take,
)
from tsas_cli.diagnosis import rivals as rivals_module
from tsas_cli.diagnosis.rivals import (
    exchanged,
    is_presliding,
    leaving_noise,
    rivals_of,
    rivals_within,
)


@pytest.fixture
def made(monkeypatch):
    return search_over(monkeypatch)


def test_rivals_convince_too_and_are_not_surely_worse(made, monkeypatch):
    fits = made({names(C): 1.001, names(D): 1.001, names(A): 1.0, names(): 4.0})
    monkeypatch.setattr(
        rivals_module, "add", lambda *_: [(A, CONVINCES), (C, CONVINCES), (D, DOES_NOT)]
    )
    assert rivals_of(fits, names(A), A) == (C,)  # itself is none, and D convinces nobody
    fits.trial(names(C)).solution.converged = False
    assert rivals_of(fits, names(A), A) == ()
    worse = made({names(C): 1.02, names(A): 1.0, names(): 4.0})
    monkeypatch.setattr(rivals_module, "add", lambda *_: [(C, CONVINCES)])
    assert rivals_of(worse, names(A), A) == ()


def searched(squares, mesh=False):
    """Return the fits of a search with these mean squares, and what all of them are."""
    found = SimpleNamespace(
        squares={
            (of, mesh and of != names(A)): np.full(BLOCKS, value * SIZE / BLOCKS)
            for of, value in squares.items()
        },
        folds=SimpleNamespace(block=np.zeros(SIZE)),
    )
    of = SimpleNamespace(solution=SimpleNamespace(converged=True))
    found.trials = dict.fromkeys(found.squares, of)
    return found, of


@pytest.mark.parametrize(("mesh", "rivals"), [(False, (C,)), (True, ())])
def test_what_did_as_well_in_the_search_is_a_rival_when_others_are_left_out(mesh, rivals):
    """Of twice the noise's squares, half are structure: a twentieth may be chance."""
    squares = {names(A): 2.0, names(C): 2.09, names(D): 2.11, names(A, C): 1.0, names(): 1.5}
    found, of = searched(squares, mesh)
    assert rivals_within(found, names(A), A) == rivals
    of.solution.converged = False
    assert rivals_within(found, names(A), A) == ()


def test_what_leaves_noise_in_the_place_of_another_is_found_best_first():
    squares = {names(A): 1.0, names(C): 2.9, names(D): 1.1, names(): 16.0}
    found, of = searched(squares | {names(C, D): 1.0})
    assert leaving_noise(found, names(A), A) == (D, C)
    assert leaving_noise(searched(squares | {names(C): 3.1})[0], names(A), A) == (D,)
    of.solution.converged = False
    assert leaving_noise(found, names(A), A) == ()


@pytest.mark.parametrize(("part", "rivals"), [(0.29, ()), (0.31, (C,))])
def test_what_cannot_take_away_as_much_is_no_rival(made, part, rivals):
    """Of 4.0 the named one takes 3.0 away; 0.4 of that is 0.3 of the squares."""
    fits = made({names(): 4.0, names(A): 1.0, names(C): 1.0})
    seen(fits, names(), (A, 0.75), (C, part))
    assert rivals_of(fits, names(A), A) == rivals


@pytest.mark.parametrize(
    ("unsure", "of_forms", "rivals"),
    [(0.0, 0.0, ()), (0.025, 0.0, ()), (0.035, 0.0, (C,)), (0.0, 0.04, ()), (0.0, 0.06, (C,))],
)
def test_what_leaves_a_little_more_is_a_rival(made, unsure, of_forms, rivals, monkeypatch):
    """4 % more: beyond the one per cent that tells right models apart; it takes 5 % less away."""
    fits = made({names(): 9.0, names(A): 4.8, names(C): 5.0})
    monkeypatch.setattr(rivals_module, "add", lambda *_: [(C, CONVINCES)])
    assert rivals_of(fits, names(A), A, unsure, of_forms) == rivals


@pytest.mark.parametrize(
    ("share", "in_sample", "rivals"), [(0.51, 3.9, (C,)), (0.51, 4.1, ()), (0.49, 3.9, ())]
)
def test_what_fits_clearly_better_without_tolerances_is_a_rival(
    made, share, in_sample, rivals, monkeypatch
):
    """With them it predicts worse; where they take most, they decide between the two."""
    fits = made({names(): 9.0, names(A): 8.0, names(C): in_sample})
    monkeypatch.setattr(rivals_module, "add", lambda *_: [(C, CONVINCES)])
    tolerances_take(monkeypatch, share)
    for effects, held_out in ((names(A), 1.0), (names(C), 1.5)):
        of = effects, fits.trial(effects).on_mesh
        fits.squares[of] = fits.scattered[of] = np.full(BLOCKS, held_out * SIZE / BLOCKS)
    assert rivals_of(fits, names(A), A) == rivals


@pytest.mark.parametrize(("in_sample", "rivals"), [(1.0, (C,)), (1.001, ())])
def test_what_its_parameters_cost_is_no_reason_against_a_rival(
    made, in_sample, rivals, monkeypatch
):
    """It predicts worse by 2 %, and fits all the data as well, or worse."""
    fits = made({names(): 9.0, names(A): 1.0, names(C): in_sample})
    monkeypatch.setattr(rivals_module, "add", lambda *_: [(C, CONVINCES)])
    for effects, held_out in ((names(A), 1.0), (names(C), 1.02)):
        of = effects, fits.trial(effects).on_mesh
        fits.squares[of] = fits.scattered[of] = np.full(BLOCKS, held_out * SIZE / BLOCKS)
    assert rivals_of(fits, names(A), A) == rivals


def test_a_rival_that_is_better_beside_the_others_takes_its_place(made, monkeypatch):
    """Found first, C is worse than D once A is there; alone, it is better."""
    alone = {names(): 9.0, names(A): 5.0, names(C): 3.0, names(D): 4.0}
    fits = made(alone | {names(A, C): 1.2, names(A, D): 1.0, names(C, D): 2.9})
    monkeypatch.setattr(rivals_module, "add", lambda *_: ALL_CONVINCE)
    assert exchanged(fits, names(A, C)) == names(A, D)
    assert exchanged(fits, names(A, D)) == names(A, D)


def test_of_two_that_do_as_well_the_one_with_fewer_parameters_is_named(made, monkeypatch):
    """A size at its bound does not count, a shape does."""
    fits = made({names(): 9.0, names(A): 1.0, names(C): 1.0, names(D): 1.5})
    monkeypatch.setattr(rivals_module, "add", lambda *_: ALL_CONVINCE)
    assert exchanged(fits, names(A)) == names(A)
    assert exchanged(fits, names(C)) == names(C)
    for name, at_bound in ((A, [False]), (C, [True, False])):
        fit = fits.trial(names(name))
        fit.unknowns = [SimpleNamespace(name=f"{name}.{p.name}") for p in OF[name].parameters]
        fit.solution.at_bound = at_bound
    assert exchanged(fits, names(C)) == names(C)
    fits.trial(names(C)).solution.at_bound = [False, False]
    assert exchanged(fits, names(C)) == names(A)


@pytest.mark.parametrize(
    ("named", "travel_mm", "may_be"),
    [
        (("load_hysteresis",), 0.05, True),
        (("load_hysteresis",), 0.07, False),  # a hundredth of the stroke is 0.06 mm
        (("load_hysteresis", "load_friction"), 0.05, False),
        (("load_relaxation",), 0.05, False),
    ],
)
def test_a_hysteresis_that_yields_at_once_may_be_friction_that_slides_late(
    named, travel_mm, may_be
):
    trial = SimpleNamespace(values=lambda: {"load_hysteresis.travel_mm": travel_mm})
    bench = SimpleNamespace(longest_stroke_mm=6.0)
    fits = SimpleNamespace(bench=bench, trial=lambda _: trial)
    assert is_presliding(fits, frozenset(named)) == may_be
