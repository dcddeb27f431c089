"""Bounded least squares with few unknowns and many residuals: Levenberg and Marquardt.

Each step solves the normal equations of a few unknowns, which for tens of thousands of residuals
is a hundred times cheaper than the decompositions of the whole Jacobian in scipy's
`least_squares`; simulations dominate the cost. An unknown that reaches its bound stays there while
the gradient points outwards, and the others step on (active set).

With slopes that are known nearly, from another fit, the Jacobian is corrected after each step by
what the step has shown (Broyden 1965), and calculated where several steps fail, or one reduces the
squares by less than predicted, and at the end.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tsas_cli.support.arrays import Floats, Mask

FIRST_DAMPING = 1e-4  # of the diagonal of the normal equations
MOST_DAMPING = 1e8
STEP = 1e-7  # change of all unknowns below which a step is the last
LAST = 0.01  # of the tolerance, below which a step is not worth its residual; with known slopes
AS_PREDICTED = 0.5  # share of the predicted reduction, beyond which corrected slopes are kept
MOST_FAILED = 3  # steps with corrected slopes that fail one after the other
NEARLY_BOUND = 1e-4  # of a unit, or of the width between the bounds if it is less


@dataclass(frozen=True)
class Solution:
    """A minimum: unknowns (p,), bound flags, residual (n,) and Jacobian (n, p) there.

    The Jacobian is that before the last step where `slopes` were known.
    """

    values: Floats
    at_bound: Mask
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
    slopes: Floats | None = None,
    values_only: bool = False,
) -> Solution:
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
    slopes
        Nearly the Jacobian at the start, shape (n, p), where it is known.
    values_only
        Whether the Jacobian at the minimum may be such a corrected one.
    """
    lower, upper = bounds
    near = NEARLY_BOUND * np.minimum(upper - lower, 1.0)

    def found(message: str, *, converged: bool = True) -> Solution:
        at_bound = (x - lower < near) | (upper - x < near)
        return Solution(x, at_bound, r, J, converged, message, evaluations)

    x = np.clip(start, lower, upper)
    r, exact = residual(x), slopes is None
    J = jacobian(x) if slopes is None else slopes
    damping, evaluations, failed = FIRST_DAMPING, 1, 0
    while evaluations < most:
        gradient, gram = J.T @ r, J.T @ J
        at_bound = ((x <= lower) & (gradient > 0.0)) | ((x >= upper) & (gradient < 0.0))
        step = _step(gradient, gram, at_bound, damping)
        inside = np.clip(x + step, lower, upper) - x
        squares = float(r @ r)
        if np.any(inside != step):
            inside = _bounded_step(step, gradient, gram, (lower - x, upper - x), damping)
        step = inside
        predicted = -2.0 * float(gradient @ step + 0.5 * step @ gram @ step)
        reliable = exact or values_only
        if predicted <= tolerance * (LAST if reliable and slopes is not None else 1.0) * squares:
            if reliable:
                return found("no step reduces the squares further")
            J, exact = jacobian(x), True
            continue
        trial = residual(x + step)
        evaluations += 1
        reduction = squares - float(trial @ trial)
        smallest = float(np.abs(step).max()) < STEP
        if reduction > 0.0:
            last = reliable and (reduction < tolerance * squares or smallest)
            x, before, r = x + step, r, trial
            exact = slopes is None or (reduction < AS_PREDICTED * predicted and not last)
            if exact:
                J = jacobian(x)
            elif not last:
                J = _corrected(J, step, r - before, gram)
            damping, failed = max(damping / 10.0, 1e-12), 0
            if last:
                return found("the last step is within the tolerance")
        elif exact:
            damping *= 10.0
            if smallest or damping > MOST_DAMPING:
                return found("no step reduces the squares")
        elif failed < MOST_FAILED and np.isfinite(reduction):
            J = _corrected(J, step, trial - r, gram)
            damping, failed = 10.0 * damping, failed + 1
        else:
            J, exact, damping = jacobian(x), True, FIRST_DAMPING
    return found(f"squares still decreasing after {most} evaluations", converged=False)


def _corrected(J: Floats, step: Floats, change: Floats, gram: Floats) -> Floats:
    """Return the Jacobian changed least, by weights of the unknowns, to predict what a step did."""
    along = np.diag(gram) * step
    return np.asarray(J + np.outer(change - J @ step, along / float(along @ step)))


def _bounded_step(
    step: Floats, gradient: Floats, gram: Floats, bounds: tuple[Floats, Floats], damping: float
) -> Floats:
    """Return a damped step within bounds: what reaches one first stops there, the others go on.

    A step that is cut in one unknown alone would leave the valley that it shares with others.
    """
    fixed = np.zeros(step.size, bool)
    at, toward = np.zeros(step.size), step
    while True:
        beyond = ((toward < bounds[0]) | (toward > bounds[1])) & ~fixed
        if not beyond.any():
            return toward
        end = np.clip(toward, *bounds)
        room, wanted = np.abs(end - at), np.abs(toward - at)
        way = np.divide(room, wanted, out=np.zeros(step.size), where=wanted > 0.0)
        way[~beyond] = np.inf
        first = int(np.argmin(way))
        at = at + way[first] * (toward - at)
        at[first], fixed[first] = end[first], True
        toward = at + _step(gradient + gram @ at, gram, fixed, damping)


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
