"""A fault by one unknown, beside the parameters of a trial and the tolerances of a rig."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tsas_cli.diagnosis.friction_scatter import friction_of_runs
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.screening import orthogonal_to
from tsas_cli.support.arrays import Floats, Indices

TINY = 1e-9


@dataclass(frozen=True)
class Candidate:
    """A fault by one unknown: what it is, where, the amount, and the squares that it takes away.

    The `amount` of an offset and of steps is in the unit of the channel, of a gain and of a clock a
    share, of a delay and of a lag in s, of an amplifier its time constant [s], of a friction and of
    a stiffness the logarithm of a factor, of a swing its frequency [Hz], of a saturation its level.
    `run` is None for a fault of all runs; `edges` counts the ends of the part of the run that it
    is in, from `first_s` to `last_s`. A run is `alone` if no other has its bend. `steps` are the
    times and amounts of several steps of a zero.
    """

    code: str
    run: int | None
    channels: tuple[str, ...]
    amount: float
    reduction: float
    edges: int = 0
    first_s: float | None = None
    last_s: float | None = None
    alone: bool = False
    steps: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, eq=False)
class Beside:
    """The residual of a trial beside its parameters and tolerances, and columns beside them."""

    basis: Floats  # orthonormal, of residuals and priors, shape (n + m, p)
    residual: Floats
    squares: float

    def project(self, columns: Floats) -> Floats:
        """Return columns, shape (n, m), beside the basis."""
        n = columns.shape[0]
        padded = np.vstack((columns, np.zeros((self.basis.shape[0] - n, columns.shape[1]))))
        return np.asarray(padded - self.basis @ (self.basis.T @ padded))

    def without(self, column: Floats) -> "Beside":
        """Return the residual beside a column too, shape (n,)."""
        own = self.project(column[:, None])
        own = own / np.linalg.norm(own)
        residual = self.residual - own[:, 0] * float(own[:, 0] @ self.residual)
        return Beside(np.hstack((self.basis, own)), residual, float(residual @ residual))


def beside(trial: HypothesisFit, tolerated: Floats, run: Indices, *, alike: bool = False) -> Beside:
    """Return the residual that neither the parameters of a trial nor tolerances explain.

    The friction of the runs has a tolerance, unless it is `alike` in all of them.
    """
    free = trial.solution.jacobian[:, ~trial.solution.at_bound]
    frictions = friction_of_runs(trial, run)
    if alike:
        frictions = frictions[:, :0]
    own = np.column_stack((frictions, tolerated))
    count = own.shape[1]
    size = np.linalg.norm(free, axis=0)
    columns = np.hstack((free[:, size > 0.0] / size[size > 0.0], own))
    priors = np.hstack((np.zeros((count, np.count_nonzero(size))), np.eye(count)))
    basis = np.linalg.qr(np.vstack((columns, priors)))[0]
    residual = np.append(trial.solution.residual, np.zeros(count))
    residual = orthogonal_to(basis, residual)
    return Beside(basis, residual, float(residual @ residual))


def one(
    code: str, k: int | None, channels: tuple[str, ...], column: Floats, left: Beside
) -> Iterator[Candidate]:
    """Yield a fault by its column beside the basis, shape (n + m,), if it changes anything."""
    square = float(column @ column)
    if square > TINY:
        along = float(column @ left.residual)
        yield Candidate(code, k, channels, along / square, along**2 / square)
