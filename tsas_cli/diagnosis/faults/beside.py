"""A fault by one unknown, beside the parameters of a trial and the tolerances of a rig."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from tsas_cli.diagnosis.friction_scatter import friction_of_runs
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.screening import orthogonal_to
from tsas_cli.support.arrays import Floats, Indices

TINY = 1e-9
HIDDEN = 1e-9  # share of a column's squares, below which the basis holds it


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
    """The residual of a trial beside its parameters and tolerances, or its rows of one run.

    `basis` is orthonormal, of residuals and of priors, shape (n + m, p), `residual` orthogonal to
    it, shape (n + m,), `runs` the rows of each run.
    """

    basis: Floats
    residual: Floats
    runs: tuple[slice, ...] = ()

    @cached_property
    def squares(self) -> float:
        """The squares of the residual."""
        return float(self.residual @ self.residual)

    def in_run(self, k: int) -> "Beside":
        """Return the rows of one run, for columns that are zero in all others."""
        return Beside(self.basis[self.runs[k]], self.residual[self.runs[k]])

    def seen(self, columns: Floats) -> tuple[Floats, Floats]:
        """Return the products of columns beside the basis with each other and with the residual.

        Their shape is (n, m), that of the products (m, m) and (m,).
        """
        n = columns.shape[0]
        along = self.basis[:n].T @ columns
        return columns.T @ columns - along.T @ along, columns.T @ self.residual[:n]

    def without(self, k: int, column: Floats) -> "Beside":
        """Return the residual beside a column of one run too, shape (r,)."""
        whole = np.zeros((self.residual.size, 1))
        whole[self.runs[k], 0] = column
        own = orthogonal_to(self.basis, whole)
        own = own / np.linalg.norm(own)
        basis = np.hstack((self.basis, own))
        return Beside(basis, orthogonal_to(own, self.residual), self.runs)


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
    ends = np.searchsorted(run, np.arange(run[-1] + 2))
    runs = tuple(slice(first, last) for first, last in pairwise(ends.tolist()))
    return Beside(basis, orthogonal_to(basis, residual), runs)


def one(
    code: str, k: int | None, channels: tuple[str, ...], column: Floats, left: Beside
) -> Iterator[Candidate]:
    """Yield a fault by its column, shape (n,), if it changes anything beside the basis."""
    products, along = left.seen(column[:, None])
    square, score = float(products[0, 0]), float(along[0])
    if square > max(TINY, HIDDEN * float(column @ column)):
        yield Candidate(code, k, channels, score / square, score**2 / square)
