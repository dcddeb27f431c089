"""Bounded least squares with few unknowns and many residuals: Levenberg and Marquardt.

Each step solves the normal equations of a few unknowns, which for tens of thousands of residuals
is a hundred times cheaper than the decompositions of the whole Jacobian in scipy's
`least_squares`, and the simulations are what counts. An unknown that a step drives against its
bound stays there until the gradient leads it back (projected steps).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

FIRST_DAMPING = 1e-4  # of the diagonal of the normal equations
MOST_DAMPING = 1e8
STEP = 1e-7  # change of all unknowns below which a step is the last


@dataclass(frozen=True)
class Minimum:
    """Where the squares are least: unknowns (p,), residual (n,) and Jacobian (n, p) there."""

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
    """Minimise half the sum of squares of the residual within bounds.

    Parameters
    ----------
    residual, jacobian
        Functions of the unknowns, shapes (n,) and (n, p).
    start
        The unknowns to start from, shape (p,); those outside of the bounds are moved onto them.
    bounds
        Lower and upper bounds, each of shape (p,).
    tolerance
        The part of the squares that a last step may still have saved, or promise to save.
    most
        The number of evaluations of the residual after which the search is given up.
    """
    lower, upper = bounds
    x = np.clip(start, lower, upper)
    r, J = residual(x), jacobian(x)
    damping, evaluations = FIRST_DAMPING, 1
    while evaluations < most:
        gradient, gram = J.T @ r, J.T @ J
        held = ((x <= lower) & (gradient > 0.0)) | ((x >= upper) & (gradient < 0.0))
        step = _step(gradient, gram, held, damping)
        step = np.clip(x + step, lower, upper) - x
        promised = -float(gradient @ step + 0.5 * step @ gram @ step)
        squares = float(r @ r)
        if promised <= 0.5 * tolerance * squares:
            return Minimum(x, r, J, True, "no step saves more", evaluations)
        tried = residual(x + step)
        evaluations += 1
        saved = squares - float(tried @ tried)
        if saved > 0.0:
            x, r, J = x + step, tried, jacobian(x + step)
            damping = max(damping / 10.0, 1e-12)
            if saved < tolerance * squares or np.abs(step).max() < STEP:
                return Minimum(x, r, J, True, "the last step saved little", evaluations)
        else:
            damping *= 10.0
            if np.abs(step).max() < STEP or damping > MOST_DAMPING:
                return Minimum(x, r, J, True, "no step saves anything", evaluations)
    return Minimum(x, r, J, False, f"still falling after {most} evaluations", evaluations)


def _step(gradient: Floats, gram: Floats, held: npt.NDArray[np.bool_], damping: float) -> Floats:
    """Return the damped Gauss-Newton step of the unknowns that are not held at a bound."""
    step = np.zeros(gradient.size)
    free = np.flatnonzero(~held & (np.diag(gram) > 0.0))
    if free.size:
        scale = np.sqrt(np.diag(gram)[free])  # makes the equations free of units
        matrix = gram[np.ix_(free, free)] / np.outer(scale, scale)
        matrix[np.diag_indices(free.size)] += damping
        step[free] = -np.linalg.lstsq(matrix, gradient[free] / scale, rcond=1e-14)[0] / scale
    return step
