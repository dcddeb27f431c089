"""A ridge regression on recorded signals: what any model of them could explain, held out."""

import numpy as np
import numpy.typing as npt

from tsas_cli.support.arrays import Floats

HATS = 10  # hat functions of each signal and direction
RIDGE = 1.0  # regularisation, in units of noise


def hats(signal: Floats, direction: Floats) -> Floats:
    """Return linear interpolation weights of a signal, for both directions, shape (n, p)."""
    knots = np.unique(np.quantile(signal, np.linspace(0.0, 1.0, HATS)))
    if knots.size < 2:
        return np.zeros((signal.size, 0))
    weights = np.array([np.interp(signal, knots, row) for row in np.eye(knots.size)]).T
    pulling = (direction > 0.0)[:, None]
    return np.hstack((weights * pulling, weights * ~pulling))


def regressed(columns: Floats, residual: Floats, fold: npt.NDArray[np.int64]) -> Floats:
    """Return the ridge regression's prediction in each fold, fitted to all others, shape (n,)."""
    out = np.zeros(residual.size)
    gram, score = columns.T @ columns, columns.T @ residual
    ridge = RIDGE * np.eye(columns.shape[1])
    for number in np.unique(fold):
        here = fold == number
        own = columns[here]
        rest = gram - own.T @ own + ridge
        out[here] = own @ np.linalg.solve(rest, score - own.T @ residual[here])
    return out
