"""Bounded least squares over several runs, with an identifiability check before the fit.

The unknowns are scaled (logarithms of positive parameters); each run has a vector of residuals in
units of its noise. A parameter of one run affects that run's residuals only, and its column of the
Jacobian costs one simulation of that run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.numerics.covariance import inverse_gram, jackknife, numbered_on
from tsas_cli.numerics.least_squares import Solution, least_squares
from tsas_cli.numerics.side_by_side import each
from tsas_cli.support.arrays import Floats, Indices, Mask

Residuals = Callable[[int, Floats], Floats]  # of one run, at given unknowns

STEP = 1e-5  # of the finite differences, in scaled unknowns
MOST_EVALUATIONS = 60
WRONG = 2.0  # mean square of the residuals beyond which the model is wrong
FEWEST_RUNS = 3  # for standard errors of a wrong model
ALONE = 50.0  # growth of the variance of a parameter without the run that alone determines it
UNDETERMINED = 1e-3  # tolerance of the resolution of a determined parameter
INDEPENDENT = 1e-3  # share of an unknown's column that has to be independent of the others
COLOUR = 10.0  # ratio of the standard errors for coloured and for white noise, at most


@dataclass(frozen=True)
class Unknown:
    """One unknown: scaled initial value, bounds and plausible change; its run, None if shared.

    `prior` is the weight of its distance from 0 among the residuals, where a fit has to be kept
    from values that the data hardly determine.
    """

    name: str
    run: int | None
    initial: float
    lower: float
    upper: float
    scale: float
    prior: float = 0.0


@dataclass(frozen=True)
class Fitted:
    """A fit: scaled values, standard errors, Student's t, bound flags, convergence."""

    values: Floats
    stderr: Floats
    t: Floats
    at_bound: Mask
    converged: bool
    message: str
    evaluations: int


def jacobian(
    unknowns: Sequence[Unknown],
    runs: int,
    values: Floats,
    residuals: Residuals,
    *,
    at_once: bool = True,
    known: Floats | None = None,
) -> Floats:
    """Return the Jacobian of all runs' residuals by finite differences, shape (n, p).

    Of `known` slopes, shape (n, p), only the columns with NaN are calculated.
    """
    base = each(lambda r: residuals(r, values), range(runs), at_once=at_once)
    starts = np.concatenate(([0], np.cumsum([b.size for b in base])))

    def slope(at: tuple[int, int]) -> Floats:
        r, j = at
        moved = values.copy()
        moved[j] += STEP if values[j] + STEP <= unknowns[j].upper else -STEP
        change: Floats = residuals(r, moved) - base[r]
        return change / float(moved[j] - values[j])

    known = np.full((int(starts[-1]), len(unknowns)), np.nan) if known is None else known
    new: Mask = np.asarray(np.isnan(known).any(axis=0))
    owned = [(r, j) for j, u in enumerate(unknowns) for r in range(runs) if u.run in (None, r)]
    places = [(r, j) for r, j in owned if new[j]]
    out = np.where(new, 0.0, known)
    for (r, j), column in zip(places, each(slope, places, at_once=at_once), strict=True):
        out[starts[r] : starts[r + 1], j] = column
    return out


def identifiable(unknowns: Sequence[Unknown], J: Floats) -> tuple[list[int], dict[int, list[int]]]:
    """Return the unknowns that are identifiable together, chosen in the given order.

    They are where the residuals, their noise coloured, leave less than their plausible change: a
    fixed one that is off by that much would be the larger part of what remains.

    Returns
    -------
    chosen, confounded
        Indices of the identifiable unknowns; for each other one the indices of those that it is
        not identifiable together with, strongest first, empty where it is not identifiable alone.
    """
    scaled: Floats = np.asarray(np.linalg.qr(J * np.array([u.scale for u in unknowns]), mode="r"))
    chosen: list[int] = []
    confounded: dict[int, list[int]] = {}
    for j in range(len(unknowns)):
        column = scaled[:, j]
        weights = (
            np.linalg.lstsq(scaled[:, chosen], column, rcond=None)[0] if chosen else np.zeros(0)
        )
        new = float(np.linalg.norm(column - scaled[:, chosen] @ weights))
        if new > COLOUR and new > INDEPENDENT * float(np.linalg.norm(column)):
            chosen.append(j)
        else:
            imitated = np.linalg.norm(scaled[:, chosen] * weights, axis=0)
            visible = float(np.linalg.norm(column)) > COLOUR
            order = np.argsort(-imitated) if visible else np.zeros(0, dtype=np.int64)
            confounded[j] = [chosen[k] for k in order if imitated[k] > 0.1 * imitated.max()]
    return chosen, confounded


def solve(
    unknowns: Sequence[Unknown],
    runs: int,
    residuals: Residuals,
    *,
    tolerance: float,
    differing: Residuals | None = None,
    at_once: bool = True,
    known: Floats | None = None,
    values_only: bool = False,
) -> Solution:
    """Return the minimum of the squares of all runs' residuals within the bounds.

    Priors of the unknowns count too, and are no rows of the solution. `tolerance` is the share of
    the squares below which a reduction ends the search; `at_once` whether simulations are long
    enough to run on threads. The Jacobian is that of `differing`, residuals of a coarser simulation
    whose differences are nearly those of `residuals`, where there is one. `known` are slopes near
    the initial values, shape (n, p), with NaN in the columns of other unknowns; with `values_only`
    the Jacobian of the solution is as rough.
    """
    prior = np.diag([u.prior for u in unknowns])[[u.prior > 0.0 for u in unknowns]]

    def errors(values: Floats) -> Floats:
        of_runs = each(lambda r: residuals(r, values), range(runs), at_once=at_once)
        return np.concatenate([*of_runs, prior @ values])

    def slopes(values: Floats, known: Floats | None = None) -> Floats:
        J = jacobian(unknowns, runs, values, differing or residuals, at_once=at_once, known=known)
        return np.vstack((J, prior)) if len(prior) else J

    lower = np.array([u.lower for u in unknowns])
    upper = np.array([u.upper for u in unknowns])
    initial = np.array([u.initial for u in unknowns])
    start = np.clip(initial, lower, upper)
    found = least_squares(
        errors,
        slopes,
        start,
        (lower, upper),
        tolerance=tolerance,
        most=MOST_EVALUATIONS,
        slopes=None if known is None else slopes(start, known),
        values_only=values_only,
    )
    rows = found.residual.size - len(prior)
    return replace(found, residual=found.residual[:rows], jacobian=found.jacobian[:rows])


def with_errors(
    unknowns: Sequence[Unknown],
    solution: Solution,
    blocks: Sequence[Indices],
    *,
    by_run: bool = False,
) -> Fitted:
    """Return a solution with standard errors and Student's t of its unknowns, from blocks of runs.

    Where the model is wrong, or with `by_run`, its error repeats from block to block, and only runs
    are independent: shared unknowns get the wider interval of both, but those that one run alone
    determines, whose scatter from run to run nothing shows.
    """
    J, residual, runs = solution.jacobian, solution.residual, len(blocks)
    block = numbered_on(blocks)
    stderr, t = _errors(J, residual, block)
    if (by_run or np.mean(residual**2) > WRONG) and runs >= FEWEST_RUNS:
        own = np.repeat(np.arange(runs), [b.size for b in blocks])
        run_stderr, run_t = _errors(J, residual, own)
        wider = (run_t * run_stderr > t * stderr) & [u.run is None for u in unknowns]
        wider &= _without_a_run(J, own) < ALONE
        stderr, t = np.where(wider, run_stderr, stderr), np.where(wider, run_t, t)
    return Fitted(
        solution.values,
        stderr,
        t,
        solution.at_bound,
        solution.converged,
        solution.message,
        solution.evaluations,
    )


def _without_a_run(J: Floats, run: Indices) -> Floats:
    """Return by how much the variance of each parameter grows, at most, without one run."""
    whole = np.diag(inverse_gram(J))
    most = np.ones(J.shape[1])
    for k in np.unique(run):
        rest = J[run != k]
        shared = np.any(rest != 0.0, axis=0)
        less = np.diag(inverse_gram(rest[:, shared]))
        most[shared] = np.maximum(most[shared], less / whole[shared])
    return most


def _errors(J: Floats, residual: Floats, block: Indices) -> tuple[Floats, Floats]:
    """Return the standard errors and Student's t of the parameters, shape (p,).

    Infinite errors where the residuals do not determine a parameter at all.
    """
    covariance, t = jackknife(J, residual, block)
    determined = np.diag(inverse_gram(J) @ (J.T @ J))
    errors = np.sqrt(np.diag(covariance))
    return np.where(np.abs(determined - 1.0) < UNDETERMINED, errors, np.inf), t
