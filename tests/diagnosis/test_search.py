"""How a search decides, on fits and squares that are made up."""

from operator import attrgetter
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.searched import (
    BLOCKS,
    OF,
    A,
    C,
    D,
    names,
    pairs,
    screened,
    search_over,
    seen,
    tolerances_take,
)
from tsas_cli.diagnosis import fits as fits_module
from tsas_cli.diagnosis import search as s
from tsas_cli.diagnosis.evidence import Reduction


@pytest.fixture
def made(monkeypatch):
    return search_over(monkeypatch)


@pytest.mark.parametrize(("period_mm", "part"), [(13.3, False), (13.4, True)])
def test_a_wave_that_the_strokes_hold_less_than_one_and_a_half_times_is_part_of_one(
    period_mm, part
):
    bench = SimpleNamespace(longest_stroke_mm=20.0)
    trial = SimpleNamespace(values=lambda: {"load_ripple.period_mm": period_mm})
    assert s._is_part_of_a_wave(bench, trial, OF["load_ripple"]) == part
    assert not s._is_part_of_a_wave(bench, trial, OF["load_spring_nonlinearity"])


@pytest.mark.parametrize(
    ("left", "complete", "quiet"),
    [(1.149, False, True), (1.151, False, False), (2.9, True, True), (3.1, True, False)],
)
def test_it_is_quiet_up_to_the_blur_of_a_right_model_and_slow_noise_up_to_its_limit(
    made, left, complete, quiet, monkeypatch
):
    fits = made({names(A): left})
    monkeypatch.setattr(s, "is_complete", lambda fits, names: complete)
    assert s.is_quiet(fits, names(A)) == quiet


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
    fits = made({names(): nothing, names(A): one, names(A, C): two})
    if two is None:
        assert s.matters(fits, names(), {A}) == matters
    else:
        assert s.matters(fits, names(A), {C}) == matters


def test_gains_are_those_of_the_squares(made):
    fits = made({names(): 4.0, names(A): 1.0})
    found = fits.gain(names(), names(A))
    assert found.part == pytest.approx(0.75)
    assert found.test_statistic == pytest.approx(
        np.sqrt(1.5 * BLOCKS * (BLOCKS + 1) / (2 * BLOCKS + 1))
    )
    assert fits.gain(names(A), names()).part == pytest.approx(-3.0)


@pytest.mark.parametrize(("in_line", "part"), [(False, 0.75), (True, 0.5)])
def test_gains_are_beside_the_friction_of_each_run_unless_it_changes_with_the_session(
    made, monkeypatch, in_line, part
):
    """Own frictions leave half of what the effect leaves, and all that none leaves."""
    halved = {2.0: 1.0, 4.0: 4.0}
    monkeypatch.setattr(
        fits_module,
        "with_friction_of_runs",
        lambda trial, run: SimpleNamespace(mean_square=halved[trial.mean_square]),
    )
    monkeypatch.setattr(fits_module, "is_in_line", lambda trial, run, session_s: in_line)
    fits = made({names(): 4.0, names(A): 2.0})
    assert fits.gain(names(), names(A)).part == pytest.approx(part)


@pytest.mark.parametrize(("bend_rad", "lines"), [(1.0, 2), (0.0, 1)])
def test_a_straight_sheath_has_no_friction_over_the_inverse_of_its_bend(
    made, monkeypatch, bend_rad, lines
):
    looked_at = []
    monkeypatch.setattr(
        fits_module, "is_in_line", lambda trial, run, over: looked_at.append(over) or False
    )
    fits = made({names(): 4.0})
    fits.bench.rigs = (
        SimpleNamespace(total_bend_rad=2.0),
        SimpleNamespace(total_bend_rad=bend_rad),
    )
    assert fits.scatters(names(), mesh=False)
    assert len(looked_at) == lines


@pytest.mark.parametrize(("by_tolerances", "found"), [(0.0, [C, A]), (0.2, [D, C, A])])
def test_only_what_is_seen_beside_the_best_is_fitted_the_best_gain_first(
    made, monkeypatch, by_tolerances, found
):
    """A fifth of the best is 0.1; what tolerances take, the best may be no more than."""
    fits = made({names(): 4.0, names(A): 3.0, names(C): 2.0, names(D): 1.0})
    tolerances_take(monkeypatch, by_tolerances)
    seen(fits, names(), (A, 0.5), (C, 0.11), (D, 0.09))
    assert [name for name, _ in s.add(fits, names())] == found
    assert (names(D) in fits.bench.fitted) == (D in found)


@pytest.mark.parametrize(("least", "found"), [(0.99, [C, A]), (1.01, [A])])
def test_what_cannot_reduce_the_squares_enough_is_not_fitted(made, least, found):
    """Of 4.0, 0.4 of a reduction by one is a tenth."""
    fits = made({names(): 4.0, names(A): 3.0, names(C): 2.0})
    seen(fits, names(), (A, 0.4), (C, 0.1))
    assert [name for name, _ in s.add(fits, names(), least)] == found


def test_a_fit_that_is_worse_with_more_freedom_starts_again_closer(made):
    parameter = OF[C].parameters[0]
    fits = made({names(): 4.0, names(C): [9.0, 5.0, 3.0]})
    fits.fit(names(), names(C), screened(C, start=parameter.neutral + 1.0))
    starts = [fit.start for fit in fits.bench.fits if fit.fitted == names(C)]
    away = [next(iter(at.values())) - parameter.neutral for at in starts]
    assert away == pytest.approx([1.0, 0.2, 0.04])
    ready = [fit.near.ready[0] for fit in fits.bench.fits if fit.fitted == names(C)]
    assert ready == pytest.approx([1.0, 0.2, 0.04])  # for a change as much smaller
    assert fits.trial(names(C)).mean_square == 3.0


@pytest.mark.parametrize(
    ("nothing", "part", "statistic", "found"),
    [
        (0.99, 0.5, 3.69, False),
        (0.99, 0.03, 3.71, True),
        (1.05, 0.09, 3.69, False),
        (1.05, 0.11, 2.7, True),
        (1.05, 0.03, 3.71, True),
        (1.05, 0.02, 9.0, False),
        (1.3, 0.09, 2.7, True),
    ],
)
def test_of_noise_alone_a_first_effect_has_to_take_more(
    made, nothing, part, statistic, found, monkeypatch
):
    """A tenth, or be more significant, alone below the noise; a fortieth where more is left."""
    fits = made({names(): nothing, names(A): nothing * (1.0 - part)})
    monkeypatch.setattr(s, "is_complete", lambda fits, names: False)
    monkeypatch.setattr(s, "add", lambda *_: [(A, Reduction(part, statistic))])
    monkeypatch.setattr(s, "_best_pair", lambda *_: None)
    assert s._better(fits, names()) == ([names(A)] if found else [])


def test_what_the_others_do_not_need_is_left_out_but_never_the_last(made):
    """One after the other, in the order of their names."""
    squares = {names(A, C, D): 1.0, names(C, D): 1.01, names(D): 1.02, names(C): 2.0}
    squares |= {names(A, D): 1.5, names(A, C): 3.0, names(): 1.02}
    assert s._without_redundant(made(squares), names(A, C, D)) == names(D)
    needed = {k: (1.0 if k == names(A, C, D) else 9.0) for k in squares}
    assert s._without_redundant(made(needed), names(A, C, D)) == names(A, C, D)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_two_that_hide_each_other_are_found_together(made, sign):
    """Each takes next to nothing away alone: they are two sides of nearly the same signature."""
    common, apart, other = pairs(3)
    signatures = {A: common[:, None], C: (common + 0.1 * apart)[:, None], D: other[:, None]}
    fits = made({names(): 4.0, names(A, C): 1.0, names(C): 3.95})
    fits.trial(names()).solution.residual = sign * apart
    seen(fits, names(), (A, 0.0), (C, 0.01), (D, 0.0), signatures=signatures)
    assert s._best_pair(fits, names(), convinces=attrgetter("convincing")) == names(A, C)
    assert set(fits.bench.fitted) == {names(), names(A, C)}
    assert s._better(fits, names()) == [names(A, C)]


@pytest.mark.parametrize("squares", [3.99, 3.5])
def test_a_pair_has_to_convince_and_to_matter(made, squares):
    common, apart = pairs(2)
    signatures = {A: common[:, None], C: (common + 0.1 * apart)[:, None]}
    fits = made({names(): 4.0, names(A, C): squares, names(C): 3.99})
    fits.trial(names()).solution.residual = apart
    seen(fits, names(), (A, 0.0), (C, 0.01), signatures=signatures)
    assert s._best_pair(fits, names(), convinces=attrgetter("convincing")) is None
    assert s._better(fits, names()) == []
