"""What differs from run to run on every rig, and is no cause: the friction, by a small amount."""

import numpy as np

from tsas_cli.identification.extension import HypothesisFit
from tsas_cli.support.arrays import Floats, Indices

FRICTION = "friction_coefficient"
PLAUSIBLE = 2.0  # standard deviations of it
SCATTER = 0.02  # standard deviation of the friction from run to run, relative


def friction_of_runs(trial: HypothesisFit, run: Indices) -> Floats:
    """Return the residuals' change by one standard deviation of each run's friction, (n, runs)."""
    column = next((j for j, u in enumerate(trial.unknowns) if u.name == FRICTION), None)
    runs = np.arange(int(run.max()) + 1)
    if column is None or runs.size < 2:
        return np.zeros((run.size, 0))
    slope = SCATTER * trial.solution.jacobian[:, column]
    return np.asarray(slope[:, None] * (run[:, None] == runs))


def without_scatter(trial: HypothesisFit, run: Indices) -> Floats:
    """Return the residual without what a plausible friction of each run explains, shape (n,)."""
    columns, residual = friction_of_runs(trial, run), trial.solution.residual
    gram = columns.T @ columns + np.eye(columns.shape[1])
    return np.asarray(residual - columns @ np.linalg.solve(gram, columns.T @ residual))


def with_friction_of_runs(trial: HypothesisFit, run: Indices) -> HypothesisFit:
    """Return a fit with a friction of its own for each run."""
    columns = friction_of_runs(trial, run)
    names = [(f"{FRICTION} {k}", k, 1.0) for k in range(columns.shape[1])]
    return trial.with_columns(names, columns)


def within_scatter(trial: HypothesisFit, change: Floats, run: Indices) -> bool:
    """Return whether most of a change of the residuals is a plausible scatter of the friction."""
    columns = friction_of_runs(trial, run)
    common = columns.sum(axis=1)  # what the friction coefficient does
    change = change - common * float(common @ change) / float(common @ common)
    frictions = np.linalg.lstsq(columns, change, rcond=None)[0]
    left = change - columns @ frictions
    plausible = np.all(np.abs(frictions - frictions.mean()) <= PLAUSIBLE)
    return bool(plausible) and float(left @ left) < 0.5 * float(change @ change)


def is_scatter(trial: HypothesisFit, column: Floats, run: Indices) -> bool:
    """Return whether a column of the Jacobian is nearly a friction of each run's own."""
    columns = friction_of_runs(trial, run)
    if not columns.shape[1]:
        return False
    basis = np.linalg.qr(columns)[0]
    left = column - basis @ (basis.T @ column)
    return float(left @ left) < 0.1 * float(column @ column)
