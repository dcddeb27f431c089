"""Bounded least squares with few unknowns and many residuals: Levenberg and Marquardt.

Each step solves the normal equations of a few unknowns, which for tens of thousands of residuals
is a hundred times cheaper than the decompositions of the whole Jacobian in scipy's
`least_squares`; simulations dominate the cost. An unknown that reaches its bound stays there while
the gradient points outwards (active set, projected steps).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tsas_cli.support.arrays import Floats, Mask

FIRST_DAMPING = 1e-4  # of the diagonal of the normal equations
MOST_DAMPING = 1e8
STEP = 1e-7  # change of all unknowns below which a step is the last


@dataclass(frozen=True)
class Minimum:
    """The minimum: unknowns (p,), with the residual (n,) and the Jacobian (n, p) there."""

    values: Floats
    residual: Floats
    jacobian: Floats
    converged: bool
    message: str
    evaluations: int


def least_squares(
    residual: Callable[[Floats], Floats],
    jacobian: Callable[[Floats], Floats],
    start: Floats,
    bounds: tuple[Floats, Floats],
    *,
    tolerance: float,
    most: int,
) -> Minimum:
    """Return the minimum of half the sum of squares of the residual within bounds.

    Parameters
    ----------
    residual, jacobian
        Functions of the unknowns, shapes (n,) and (n, p).
    start
        The unknowns to start from, shape (p,); those outside of the bounds are moved onto them.
    bounds
        Lower and upper bounds, each of shape (p,).
    tolerance
        The share of the squares below which the actual or predicted reduction ends the search.
    most
        The number of evaluations of the residual after which the search ends.
    """
    lower, upper = bounds
    x = np.clip(start, lower, upper)
    r, J = residual(x), jacobian(x)
    damping, evaluations = FIRST_DAMPING, 1
    while evaluations < most:
        gradient, gram = J.T @ r, J.T @ J
        at_bound = ((x <= lower) & (gradient > 0.0)) | ((x >= upper) & (gradient < 0.0))
        step = _step(gradient, gram, at_bound, damping)
        step = np.clip(x + step, lower, upper) - x
        predicted = -float(gradient @ step + 0.5 * step @ gram @ step)
        squares = float(r @ r)
        if predicted <= 0.5 * tolerance * squares:
            return Minimum(x, r, J, True, "no step reduces the squares further", evaluations)
        trial = residual(x + step)
        evaluations += 1
        reduction = squares - float(trial @ trial)
        if reduction > 0.0:
            x, r, J = x + step, trial, jacobian(x + step)
            damping = max(damping / 10.0, 1e-12)
            if reduction < tolerance * squares or np.abs(step).max() < STEP:
                return Minimum(x, r, J, True, "the last step is within the tolerance", evaluations)
        else:
            damping *= 10.0
            if np.abs(step).max() < STEP or damping > MOST_DAMPING:
                return Minimum(x, r, J, True, "no step reduces the squares", evaluations)
    return Minimum(
        x, r, J, False, f"squares still decreasing after {most} evaluations", evaluations
    )


def _step(gradient: Floats, gram: Floats, at_bound: Mask, damping: float) -> Floats:
    """Return the damped Gauss-Newton step of the unknowns that are not at an active bound."""
    step = np.zeros(gradient.size)
    free = np.flatnonzero(~at_bound & (np.diag(gram) > 0.0))
    if free.size:
        scale = np.sqrt(np.diag(gram)[free])  # makes the equations dimensionless
        matrix = gram[np.ix_(free, free)] / np.outer(scale, scale)
        matrix[np.diag_indices(free.size)] += damping
        step[free] = -np.linalg.lstsq(matrix, gradient[free] / scale, rcond=1e-14)[0] / scale
    return step
