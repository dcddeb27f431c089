"""Uncertainty of estimates by an unevenly bent sheath.

The model assumes an evenly bent sheath, which no sheath is. Two modes of unevenness represent all,
with a plausible prior standard deviation. The recordings determine them in part; their estimate and
their remaining uncertainty both shift the parameters.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.identification.extension import FAR, Bench, HypothesisFit
from tsas_cli.identification.fit import with_errors
from tsas_cli.support.arrays import Floats, Indices


def stderr_of_unevenness(bench: Bench, trial: HypothesisFit, blocks: Sequence[Indices]) -> Floats:
    """Return the standard error of a trial's scaled values by an uneven bend, shape (p,).

    Parameters
    ----------
    bench, trial
        The trial, and the bench it was fitted on.
    blocks
        For each run the block of each residual.
    """
    signatures = bench.unevenness(trial)
    estimate, stderr = _estimated_unevenness(trial, signatures, blocks)
    trusted = 1.0 / (1.0 + stderr**2)  # weight against the prior, of standard deviation 1
    square = (trusted * estimate) ** 2 + trusted * stderr**2
    moves = trial.moved_by(signatures)
    return np.asarray(np.sqrt(moves**2 @ square))


def _estimated_unevenness(
    trial: HypothesisFit, signatures: Floats, blocks: Sequence[Indices]
) -> tuple[Floats, Floats]:
    """Return the estimated unevenness, by one Gauss-Newton step, and its standard error."""
    solution, modes = trial.solution, signatures.shape[1]
    J = np.hstack((solution.jacobian * ~solution.at_bound, signatures))
    step = -np.linalg.pinv(J.T @ J, hermitian=True) @ (J.T @ solution.residual)
    free = replace(trial, solution=replace(solution, jacobian=J[:, :-modes]))
    extended = free.with_columns([(f"mode {k}", None, 1.0) for k in range(modes)], signatures)
    found = with_errors(extended.unknowns, extended.solution, blocks, by_run=True)
    return step[-modes:], np.minimum(found.stderr[-modes:], FAR)
