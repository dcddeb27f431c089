"""How unsure fitted values are because nobody knows how evenly the sheath is bent.

No sheath is bent evenly, and the model takes it to be. Two ways of being uneven stand for all, with
a standard deviation that is plausible before anything is measured. The recordings tell them more
or less; what they leave open, and what they ask for, moves the values.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.extension import Bench, Trial
from tsas_cli.identification.fit import Unknown, with_errors

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

FAR = 1e9  # bounds that hold nothing back


def stderr_of_unevenness(bench: Bench, trial: Trial, blocks: Sequence[Indices]) -> Floats:
    """Return by how much the scaled values of a trial may be off, shape (p,).

    Parameters
    ----------
    bench, trial
        The trial, and the bench it was fitted on.
    blocks
        For each run the block of each residual.
    """
    signatures = bench.unevenness(trial)
    asked, stderr = _told(trial, signatures, blocks)
    trusted = 1.0 / (1.0 + stderr**2)  # against the plausible size, which is 1 of each
    square = (trusted * asked) ** 2 + trusted * stderr**2
    moves = trial.moved_by(signatures)
    return np.asarray(np.sqrt(moves**2 @ square))


def _told(trial: Trial, signatures: Floats, blocks: Sequence[Indices]) -> tuple[Floats, Floats]:
    """Return how uneven the recordings ask the bend to be, one Gauss-Newton step, and its error."""
    solution, ways = trial.solution, signatures.shape[1]
    J = np.hstack((solution.jacobian * ~solution.at_bound, signatures))
    step = -np.linalg.pinv(J.T @ J, hermitian=True) @ (J.T @ solution.residual)
    free = [Unknown(f"way {k}", None, 0.0, -FAR, FAR, 1.0) for k in range(ways)]
    beside = replace(
        solution,
        values=np.append(solution.values, np.zeros(ways)),
        at_bound=np.append(solution.at_bound, np.zeros(ways, bool)),
        jacobian=J,
    )
    found = with_errors((*trial.unknowns, *free), beside, blocks, by_run=True)
    return step[-ways:], np.minimum(found.stderr[-ways:], FAR)
