"""How well a hypothesis predicts held-out runs, block by block.

A run is predicted by the fit to the others (of more than eight runs, several together), and is as
uncertain as that fit leaves its parameters: what they do not determine, such as a gain and a
friction that only another bend tells apart, is no error of the prediction. The squares are minus
twice the logarithm of the predictive density (Geisser and Eddy 1979), but for a constant. Linear:
one Gauss-Newton step from the fit to all runs leaves a run out; `refitted_values` fits again, for
what is reported. Parameters of a single run (its preload, its zeros) are fitted to that run for
every hypothesis. With fewer than three runs, stretches of the runs are held out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import Protocol

import numpy as np

from tsas_cli.identification.fit import Unknown
from tsas_cli.numerics.covariance import numbered_on
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.arrays import Floats, Indices, Mask

FEWEST_RUNS = 3  # of which one can be held out
MOST_FOLDS = 8  # of more runs, several are held out together
STRETCHES = 4  # of each run, where runs are too few
TINY = np.finfo(float).tiny
ROUNDING = 1e-14  # of a sum of squares


class Hypothesis(Protocol):
    """A fit: the unknowns, and their least squares."""

    @property
    def unknowns(self) -> Sequence[Unknown]:
        """The unknowns of the fit."""

    @property
    def solution(self) -> Solution:
        """The least squares."""


@dataclass(frozen=True)
class Folds:
    """Folds that are held out together, and blocks that are units of evidence.

    `fold`, `block` and `run` are the numbers of each residual's fold, block and run, shape (n,);
    `by_run` whether the folds are runs.
    """

    fold: Indices
    block: Indices
    run: Indices
    by_run: bool

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return int(self.block.max()) + 1

    def blocks_of_runs(self, runs: int) -> list[Indices]:
        """Return the block of each residual of each run, counted from 0 in each."""
        own = (self.block[self.run == k] for k in range(runs))
        return [np.unique(block, return_inverse=True)[1] for block in own]


def folds_of(blocks: Sequence[Indices]) -> Folds:
    """Return the folds for runs whose residuals have these blocks, each counted from 0."""
    sizes = [b.size for b in blocks]
    run = np.repeat(np.arange(len(blocks)), sizes)
    block = numbered_on(blocks)
    if len(blocks) >= FEWEST_RUNS:
        return Folds(run % MOST_FOLDS, block, run, by_run=True)
    return in_stretches(Folds(run, block, run, by_run=False))


def in_stretches(folds: Folds) -> Folds:
    """Return folds that are stretches of the runs, of the same blocks."""
    fold = np.empty_like(folds.fold)
    for k in range(int(folds.run.max()) + 1):
        block = folds.block[folds.run == k]
        block = block - block.min()
        fold[folds.run == k] = block * STRETCHES // (int(block.max()) + 1) + STRETCHES * k
    return replace(folds, fold=fold, by_run=False)


def own_of_fold(trial: Hypothesis, folds: Folds, fold: int) -> Mask:
    """Return which unknowns belong to a held-out run alone, shape (p,)."""
    if not folds.by_run:
        return np.zeros(len(trial.unknowns), bool)
    runs = np.unique(folds.run[folds.fold == fold])
    return np.array([u.run is not None and u.run in runs for u in trial.unknowns])


@dataclass(frozen=True)
class NormalEquations:
    """The sums of some residuals r and their slopes J that least squares take.

    `gram` is JᵀJ, shape (p, p), `gradient` Jᵀr, shape (p,).
    """

    gram: Floats
    gradient: Floats

    def __add__(self, other: "NormalEquations") -> "NormalEquations":
        """Return the sums of the residuals of both."""
        return NormalEquations(self.gram + other.gram, self.gradient + other.gradient)

    def squares(self, step: Floats) -> float:
        """Return what a step adds to the sum of squares."""
        return float(step @ self.gram @ step + 2.0 * self.gradient @ step)


def normal_equations(trial: Hypothesis, kept: Mask | slice = slice(None)) -> NormalEquations:
    """Return the normal equations of some residuals, of all by default."""
    J, r = trial.solution.jacobian[kept], trial.solution.residual[kept]
    return NormalEquations(J.T @ J, J.T @ r)


def held_out_values(trial: Hypothesis, folds: Folds, fold: int) -> Floats:
    """Return the scaled values of a trial without one fold, its run's own ones fitted to it."""
    held_out = folds.fold == fold
    J, r = trial.solution.jacobian[held_out], trial.solution.residual[held_out]
    own = own_of_fold(trial, folds, fold)
    step = gauss_newton_step(trial, normal_equations(trial, ~held_out))
    if own.any():
        after = r + J[:, ~own] @ step[~own]
        step[own] = -np.linalg.lstsq(J[:, own], after, rcond=None)[0]
    return _within(trial, step)


def held_out_squares(trial: Hypothesis, folds: Folds) -> Floats:
    """Return the squares of the held-out residuals in each block, shape (blocks,).

    With the fit to all runs a held-out run has its residuals there, and the others fit worse than
    by themselves. That rise, and the determinant of the prediction's covariance, count as squares
    of the held-out run's residuals, of each by the variance of its prediction.
    """
    whole, without = _with_and_without(trial, folds)
    step = gauss_newton_step(trial, whole)
    out = (trial.solution.residual + trial.solution.jacobian @ step) ** 2
    for fold, others in without.items():
        alone = gauss_newton_step(trial, others)
        weak = float(_weak(trial) @ (step**2 - alone**2))
        rise = others.squares(step) - others.squares(alone) + weak
        variance, determinant = _prediction_variance(trial, folds, fold, whole, others)
        share = variance / max(float(variance.sum()), TINY)
        out[folds.fold == fold] += (max(rise, 0.0) + determinant) * share
    return np.bincount(folds.block, out, minlength=folds.blocks).astype(np.float64)


def gauss_newton_step(trial: Hypothesis, kept: NormalEquations) -> Floats:
    """Return the Gauss-Newton step to the least squares of some residuals, shape (p,), scaled.

    What is at a bound stays there, and what reaches one stops there: the others step as if it were
    fixed, since an unknown that is cut alone would leave a valley that it shares with them.
    """
    free = ~trial.solution.at_bound
    gram = kept.gram + np.diag(_weak(trial))
    step = np.zeros(free.size)
    while free.any():
        toward = -(kept.gradient + gram @ np.where(free, 0.0, step))
        factor = _factor(gram[np.ix_(free, free)])
        step[free] = np.linalg.solve(factor.T, np.linalg.solve(factor, toward[free]))
        inside = _within(trial, step) - trial.solution.values
        beyond = free & ~np.isclose(step, inside, rtol=1e-9, atol=1e-12)
        if not beyond.any():
            break
        way = np.where(beyond, np.abs(inside) / np.maximum(np.abs(step), TINY), np.inf)
        first = int(np.argmin(way))
        step[first], free[first] = inside[first], False
    return step


def _with_and_without(
    trial: Hypothesis, folds: Folds
) -> tuple[NormalEquations, dict[int, NormalEquations]]:
    """Return the normal equations of all residuals, and by fold those of all others."""
    own = {int(k): normal_equations(trial, folds.fold == k) for k in np.unique(folds.fold)}
    none = normal_equations(trial, slice(0))
    without = {k: reduce(add, (own[other] for other in own if other != k), none) for k in own}
    return reduce(add, own.values()), without


def _weak(trial: Hypothesis) -> Floats:
    """Return the weight of each unknown's step, which determines what the residuals do not."""
    return np.array([u.scale for u in trial.unknowns]) ** -2.0


def _within(trial: Hypothesis, step: Floats) -> Floats:
    """Return the values after a step, within their bounds."""
    lower = np.array([u.lower for u in trial.unknowns])
    upper = np.array([u.upper for u in trial.unknowns])
    return np.clip(trial.solution.values + step, lower, upper)


def _prediction_variance(
    trial: Hypothesis, folds: Folds, fold: int, whole: NormalEquations, others: NormalEquations
) -> tuple[Floats, float]:
    """Return the variance of a fold's prediction by the others, over that of the noise.

    Of each residual, shape (k,), and the logarithm of the determinant of the whole covariance,
    noise included: that of the unknowns' precision with the fold, over that without it.
    """
    free = ~(own_of_fold(trial, folds, fold) | trial.solution.at_bound)
    weak = np.diag(_weak(trial))
    without, together = (
        (equations.gram + weak)[np.ix_(free, free)] for equations in (others, whole)
    )
    J = trial.solution.jacobian[folds.fold == fold][:, free]
    factor, rest = _factor(without), _factor(together)
    variance = np.sum(np.linalg.solve(factor, J.T) ** 2, axis=0)
    logarithms = np.log(np.diagonal(rest) / np.diagonal(factor))
    return variance, 2.0 * float(logarithms.sum())


def _factor(precision: Floats) -> Floats:
    """Return the lower Cholesky factor of a precision, shape (p, p), as far as rounding knows it.

    What a sum of products loses in double precision could make it indefinite. Without finite slopes
    it is NaN, which convinces nobody.
    """
    if not np.isfinite(precision).all():
        return np.full_like(precision, np.nan)
    size = np.sqrt(np.diagonal(precision))
    even = precision / np.outer(size, size) + ROUNDING * np.eye(size.size)
    return np.asarray(size[:, None] * np.linalg.cholesky(even))


def predicted_folds(trial: Hypothesis, folds: Folds) -> Folds:
    """Return the folds, or stretches where a run is needed to predict itself.

    A run is, where its prediction by the others is more uncertain than its noise.
    """
    whole, without = _with_and_without(trial, folds)
    for fold, others in without.items():
        variance, _ = _prediction_variance(trial, folds, fold, whole, others)
        if float(np.mean(variance)) > 1.0:
            return in_stretches(folds)
    return folds
