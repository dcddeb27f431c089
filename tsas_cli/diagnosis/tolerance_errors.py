"""Uncertainty of estimates by what every rig has: errors of load cells, an uneven bend.

The model assumes none of it. Each tolerance has a plausible prior standard deviation; the
recordings determine it in part, and its estimate and its remaining uncertainty both shift the
parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.diagnosis.tolerances import PLAUSIBLE
from tsas_cli.identification.extension import FAR, HypothesisFit
from tsas_cli.identification.fit import with_errors
from tsas_cli.support.arrays import Floats, Indices


def covariance_of_tolerances(
    trial: HypothesisFit, tolerated: Floats, blocks: Sequence[Indices]
) -> Floats:
    """Return the covariance of a trial's scaled values by tolerances, shape (p, p).

    Parameters
    ----------
    trial
        The trial.
    tolerated
        The residuals' changes by one standard deviation of each tolerance, shape (n, m).
    blocks
        For each run the block of each residual.
    """
    estimate, stderr = _estimated(trial, tolerated, blocks)
    trusted = 1.0 / (1.0 + stderr**2)  # weight against the prior, of standard deviation 1
    likely = np.clip(trusted * estimate, -PLAUSIBLE, PLAUSIBLE)
    moves = trial.moved_by(tolerated)
    return np.asarray((moves * (likely**2 + trusted * stderr**2)) @ moves.T)


def _estimated(
    trial: HypothesisFit, tolerated: Floats, blocks: Sequence[Indices]
) -> tuple[Floats, Floats]:
    """Return the estimated tolerances, by one Gauss-Newton step, and their standard errors."""
    solution, count = trial.solution, tolerated.shape[1]
    J = np.hstack((solution.jacobian * ~solution.at_bound, tolerated))
    step = -np.linalg.pinv(J.T @ J, hermitian=True) @ (J.T @ solution.residual)
    free = replace(trial, solution=replace(solution, jacobian=J[:, :-count]))
    names = [(f"tolerance {k}", None, 1.0) for k in range(count)]
    extended = free.with_columns(names, tolerated)
    found = with_errors(extended.unknowns, extended.solution, blocks, by_run=True)
    return step[-count:], np.minimum(found.stderr[-count:], FAR)
