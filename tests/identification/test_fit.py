"""The least squares over runs, on problems whose answer is known without it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.effects import EFFECTS, LAWS
from tsas_cli.identification.fit import (
    Solution,
    Unknown,
    identifiable,
    jacobian,
    solve,
    with_errors,
)
from tsas_cli.identification.fit_problem import further_unknown, unknown_of
from tsas_cli.identification.quantities import QUANTITIES, Quantity


def unknown(name="a", run=None, start=0.0, lower=-10.0, upper=10.0, scale=1.0):
    return Unknown(name, run, start, lower, upper, scale)


def linear(matrices, targets):
    """Return residuals that are linear in the unknowns."""
    return lambda r, values: matrices[r] @ values - targets[r]


RNG = np.random.default_rng(2)
MATRICES = [RNG.standard_normal((9, 3)), RNG.standard_normal((7, 3))]
MATRICES[0][:, 2] = 0.0  # the third belongs to the second run
TARGETS = [RNG.standard_normal(9), RNG.standard_normal(7)]
THREE = [unknown("a"), unknown("b"), unknown("c", run=1)]


@pytest.mark.parametrize("start", [0.3, 10.0])
def test_the_jacobian_asks_nothing_beyond_a_bound_nor_of_other_runs(start):
    """That of a linear problem is its matrix."""
    asked, linearly = [], linear(MATRICES, TARGETS)

    def residuals(r, values):
        asked.append((r, values.copy()))
        return linearly(r, values)

    found = jacobian(THREE, 2, np.array([start, -2.0, 0.0]), residuals)
    np.testing.assert_allclose(found, np.vstack(MATRICES), atol=1e-8)
    assert max(values[0] for _, values in asked) <= 10.0
    assert len(asked) == 2 + 2 + 2 + 1
    assert not any(r == 0 and values[2] != 0.0 for r, values in asked)


def test_the_squares_are_least_where_the_normal_equations_say():
    found = solve(THREE, 2, linear(MATRICES, TARGETS), tolerance=1e-12)
    exact = np.linalg.lstsq(np.vstack(MATRICES), np.concatenate(TARGETS), rcond=None)[0]
    np.testing.assert_allclose(found.values, exact, atol=1e-6)
    assert found.converged
    assert not found.at_bound.any()
    expected = np.vstack(MATRICES) @ exact - np.concatenate(TARGETS)
    np.testing.assert_allclose(found.residual, expected, atol=1e-5)


def test_priors_choose_among_values_that_the_data_do_not_tell_apart():
    """Of a + b, which is 3, the one with the smaller prior takes most; they are no residuals."""
    weights = np.array([2.0, 1.0])
    both = [replace(u, prior=w) for u, w in zip(THREE[:2], weights, strict=True)]
    matrix, target = np.ones((4, 2)), np.full(4, 3.0)
    found = solve(both, 1, linear([matrix], [target]), tolerance=1e-12)
    ridge = np.linalg.solve(matrix.T @ matrix + np.diag(weights**2), matrix.T @ target)
    np.testing.assert_allclose(found.values, ridge, atol=1e-6)
    assert found.values[1] == pytest.approx(4.0 * found.values[0], rel=1e-5)
    np.testing.assert_allclose(found.residual, matrix @ ridge - target, atol=1e-6)
    np.testing.assert_allclose(found.jacobian, matrix, atol=1e-6)


@pytest.mark.parametrize(("lower", "upper"), [(-10.0, -1.0), (1.5, 10.0)])
def test_a_value_at_a_bound_is_flagged(lower, upper):
    bounded = [unknown("a", lower=lower, upper=upper, start=0.5 * (lower + upper)), *THREE[1:]]
    matrices = [m.copy() for m in MATRICES]
    targets = [m @ np.array([0.0, 0.2, 0.1]) for m in matrices]
    found = solve(bounded, 2, linear(matrices, targets), tolerance=1e-12)
    assert found.at_bound.tolist() == [True, False, False]
    assert found.values[0] == pytest.approx(max(lower, min(0.0, upper)), abs=1e-3)


# An unknown is identifiable where coloured noise (10 times white) leaves its error below its scale:
# where its column, for one scale, is longer than 10.
ENOUGH, TOO_LITTLE = 10.1, 9.9


@pytest.mark.parametrize("scale", [1.0, 0.2])
def test_what_shows_enough_is_identifiable(scale):
    J = np.diag([ENOUGH, TOO_LITTLE]) / scale
    chosen, confounded = identifiable([unknown(scale=scale), unknown("b", scale=scale)], J)
    assert chosen == [0]
    assert confounded == {1: []}  # not shown at all


def test_what_another_imitates_is_confounded_with_it_the_strongest_first():
    weak, strong, other = 300.0 * np.eye(6)[:3]
    both = 1.0 * weak + 3.0 * strong
    hardly = 0.05 * weak + 1.0 * other
    J = np.column_stack((weak, strong, other, both, hardly))
    names = [unknown(n) for n in "abcde"]
    chosen, confounded = identifiable(names, J)
    assert chosen == [0, 1, 2]
    assert confounded == {3: [1, 0], 4: [2]}  # a twentieth of what the strongest does is not said


@pytest.mark.parametrize(("part", "told"), [(2e-3, True), (0.5e-3, False)])
def test_a_thousandth_of_an_effect_has_to_be_its_own(part, told):
    first, own = 1e6 * np.eye(4)[:2]
    chosen, _ = identifiable(
        [unknown(), unknown("b")], np.column_stack((first, first + part * own))
    )
    assert (chosen == [0, 1]) == told


def solution(J, residual):
    p = J.shape[1]
    return Solution(np.zeros(p), np.zeros(p, bool), residual, J, True, "", 1)


def blocks(runs, per_run, samples):
    return [np.repeat(np.arange(per_run), samples) for _ in range(runs)]


def mean_of(residual, runs, per_run=4, samples=5, *, run=None, **how):
    """Return stderr and t of a mean that all samples share."""
    J = np.ones((residual.size, 1))
    counted = blocks(runs, per_run, samples)
    found = with_errors([unknown(run=run)], solution(J, residual), counted, **how)
    return found.stderr[0], found.t[0]


@pytest.mark.parametrize("runs", [2, 3])
def test_the_error_of_a_mean_is_that_of_its_blocks(runs):
    """Leaving out one block of m at a time: s/√m with s² = Σ d²/(m − 1), of the blocks' means."""
    means = np.random.default_rng(1).standard_normal(4 * runs)
    means -= means.mean()
    stderr, _ = mean_of(np.repeat(means, 5), runs)
    assert stderr == pytest.approx(np.std(means, ddof=1) / math.sqrt(means.size), rel=1e-9)


@pytest.mark.parametrize(("runs", "size", "by_run", "wider"), [
    (3, 3.0, None, True),  # the model is wrong: only runs are independent
    (2, 3.0, None, False),  # two of them cannot stand for that
    (3, 1.2, None, False),  # mean square of 1.44: no reason to think so
    (3, 1.2, True, True),  # asked for
])  # fmt: skip
def test_where_the_model_is_wrong_runs_are_the_evidence(runs, size, by_run, wider):
    of_run = np.linspace(-1.0, 1.0, runs)
    of_run *= size / np.sqrt(np.mean(of_run**2))
    residual = np.repeat(of_run, 20)
    how = {} if by_run is None else {"by_run": by_run}
    stderr, t = mean_of(residual, runs, **how)
    by_block = np.std(np.repeat(of_run, 4), ddof=1) / math.sqrt(4 * runs)
    alone = np.std(of_run, ddof=1) / math.sqrt(runs)
    assert stderr == pytest.approx(alone if wider else by_block, rel=1e-6)
    if wider:
        assert t > 4.3  # Student's of no more than two degrees of freedom
        own, _ = mean_of(residual, runs, run=0, **how)
        assert own == pytest.approx(by_block, rel=1e-6)


def test_what_residuals_do_not_determine_has_no_error_at_all():
    J = np.column_stack((np.ones(20), np.zeros(20)))
    residual = np.random.default_rng(3).standard_normal(20)
    found = with_errors([unknown(), unknown("b")], solution(J, residual), blocks(1, 4, 5))
    assert np.isfinite(found.stderr[0])
    assert found.stderr[1] == math.inf


def test_a_quantity_is_scaled_inside_its_bounds_and_back():
    positive = Quantity("k", "N/mm", 0.1, 100.0, 1.0, positive=True)
    assert positive.scaled(20.0) == math.log(20.0)
    assert positive.scaled(1e-9) == math.log(0.1)
    assert positive.scaled(1e9) == math.log(100.0)
    assert positive.unscaled(positive.scaled(20.0)) == pytest.approx(20.0)
    sized = Quantity("x", "mm", -5.0, 5.0, 1.0, size=0.25)
    assert sized.scaled(2.0) == 8.0
    assert sized.unscaled(8.0) == 2.0
    assert sized.scaled(-9.0) == -20.0
    assert sized.closer(3.0, 0.25) == 1.5
    assert Quantity("l", "mm", 0.0, 5.0, 1.0, shape=True).closer(3.0, 0.25) == 3.0


def test_every_quantity_starts_within_its_bounds():
    for name, q in QUANTITIES.items():
        assert q.lower < q.upper, name
        assert q.lower <= q.default <= q.upper or math.isnan(q.default), name
        assert q.size > 0.0, name
        assert not q.positive or q.lower > 0.0, name


def test_an_unknown_begins_at_its_neutral_value_or_at_a_given_one():
    name = "free_tendon.proximal_length_mm"
    quantity = QUANTITIES[name]
    found = unknown_of(name)
    assert (found.initial, found.run, found.scale) == (0.0, None, 1.0)
    assert found.upper == quantity.upper / quantity.size
    assert (unknown_of(name, 2.5, 7.0).initial, unknown_of(name, 2.5, 7.0).scale) == (2.5, 7.0)

    class Told:
        def value(self, _):
            return 3.0 * quantity.size

    assert further_unknown(name, Told()).initial == pytest.approx(3.0)


def test_an_effect_is_in_units_of_the_way_from_nothing_to_its_start():
    for effect in (*EFFECTS, *LAWS):
        for one in effect.parameters:
            size = QUANTITIES[f"{effect.name}.{one.name}"].size
            way = abs(one.start - one.neutral)
            assert size == (way or abs(one.start) or 1.0), one.name
