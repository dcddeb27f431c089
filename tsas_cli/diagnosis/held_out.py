"""Residuals of a hypothesis on held-out runs, block by block.

In the search a run is held out by one Gauss-Newton step from the fit to all runs, which is exact
for a linear model; `refitted_values` fits again, for what is reported. Parameters of a single run
(its preload, its zeros) are fitted to that run for every hypothesis. With fewer than three runs,
stretches of the runs are held out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.fit import Solution, Unknown

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Bits = npt.NDArray[np.bool_]

FEWEST_RUNS = 3  # of which one can be held out
STRETCHES = 4  # of each run, where runs are too few


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


def folds_of(blocks: Sequence[Indices]) -> Folds:
    """Return the folds for runs whose residuals have these blocks, each counted from 0."""
    sizes = [b.size for b in blocks]
    run = np.repeat(np.arange(len(blocks)), sizes)
    offsets = np.concatenate(([0], np.cumsum([b.max() + 1 for b in blocks])))[:-1]
    block = np.concatenate([b + o for b, o in zip(blocks, offsets, strict=True)])
    if len(blocks) >= FEWEST_RUNS:
        return Folds(run, block, run, by_run=True)
    return in_stretches(Folds(run, block, run, by_run=False))


def in_stretches(folds: Folds) -> Folds:
    """Return folds that are stretches of the runs, of the same blocks."""
    fold = np.empty_like(folds.fold)
    for k in range(int(folds.run.max()) + 1):
        block = folds.block[folds.run == k]
        block = block - block.min()
        fold[folds.run == k] = block * STRETCHES // (int(block.max()) + 1) + STRETCHES * k
    return replace(folds, fold=fold, by_run=False)


def own_of_fold(trial: Hypothesis, folds: Folds, fold: int) -> Bits:
    """Return which unknowns belong to a held-out run alone, shape (p,)."""
    if not folds.by_run:
        return np.zeros(len(trial.unknowns), bool)
    runs = np.unique(folds.run[folds.fold == fold])
    return np.array([u.run is not None and u.run in runs for u in trial.unknowns])


def held_out_values(trial: Hypothesis, folds: Folds, fold: int) -> Floats:
    """Return the scaled values of a trial without one fold, its run's own ones fitted to it."""
    held_out = folds.fold == fold
    J, r = trial.solution.jacobian, trial.solution.residual
    own = own_of_fold(trial, folds, fold)
    shared = ~own
    weak = (
        np.array([u.scale for u in trial.unknowns]) ** -2.0
    )  # regularises directions that are not identifiable
    others = J[~held_out][:, shared]
    free = ~trial.solution.at_bound[shared]
    gram = others.T @ others + np.diag(weak[shared])
    step = np.zeros(len(trial.unknowns))
    gradient = -(others.T @ r[~held_out])
    moved = np.zeros(int(shared.sum()))
    moved[free] = np.linalg.solve(gram[np.ix_(free, free)], gradient[free])
    step[shared] = moved
    if own.any():
        after = r[held_out] + J[held_out] @ step
        step[own] = -np.linalg.lstsq(J[held_out][:, own], after, rcond=None)[0]
    lower = np.array([u.lower for u in trial.unknowns])
    upper = np.array([u.upper for u in trial.unknowns])
    return np.clip(trial.solution.values + step, lower, upper)


def held_out_squares(trial: Hypothesis, folds: Folds) -> Floats:
    """Return the sum of squares of the held-out residuals in each block, shape (blocks,)."""
    J, r = trial.solution.jacobian, trial.solution.residual
    out = np.empty(r.size)
    for fold in range(int(folds.fold.max()) + 1):
        held_out = folds.fold == fold
        step = held_out_values(trial, folds, fold) - trial.solution.values
        out[held_out] = r[held_out] + J[held_out] @ step
    return np.bincount(folds.block, out**2, minlength=folds.blocks).astype(np.float64)
