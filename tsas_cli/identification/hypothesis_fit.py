"""A hypothesis fitted: what was freed, its least squares, and what follows from its Jacobian."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from tsas_cli.identification.fit import Unknown
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.numerics.covariance import inverse_gram
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.arrays import Floats, Mask

NODES = 40  # of the slip chain, in fits
FAR = 1e9  # bounds that are never active


@dataclass(frozen=True)
class HypothesisFit:
    """One hypothesis fitted: the effects freed, and the least squares with them."""

    effects: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    solution: Solution
    sizes: tuple[int, ...]  # residuals of each run
    on_mesh: bool

    @property
    def mean_square(self) -> float:
        """Mean square of the residuals (reduced chi-square), 1 at noise level."""
        return float(np.mean(self.solution.residual**2))

    @cached_property
    def parts(self) -> list[tuple[Floats, Floats]]:
        """Residual and Jacobian of each run."""
        edges = np.cumsum(self.sizes)[:-1]
        residuals = np.split(self.solution.residual, edges)
        return list(zip(residuals, np.split(self.solution.jacobian, edges), strict=True))

    def of_effect(self, effect: str) -> Mask:
        """Return which unknowns are parameters of an effect, shape (p,)."""
        return np.array([u.name.partition(".")[0] == effect for u in self.unknowns])

    def change_by(self, effect: str) -> Floats:
        """Return the residuals' change by an effect, from its neutral value on, shape (n,)."""
        own = self.of_effect(effect)
        quantities = [QUANTITIES[u.name] for u in self.unknowns]
        neutral = np.array([q.scaled(q.default) for q in quantities])
        change: Floats = self.solution.jacobian[:, own] @ (self.solution.values - neutral)[own]
        return change

    def moved_by(self, changes: Floats) -> Floats:
        """Return the shifts of the estimates, (p, m), for changes of the residuals, (n, m)."""
        free = ~self.solution.at_bound
        J = self.solution.jacobian[:, free]
        moves = np.zeros((free.size, changes.shape[1]))
        moves[free] = -inverse_gram(J) @ (J.T @ changes)
        return moves

    def ready_for(self, change: Floats) -> Self:
        """Return the fit with its values moved to where they fit best beside a change, shape (n,).

        As a start for a fit with what changes the residuals so; linear, within the bounds.
        """
        moved = self.solution.values + self.moved_by(change[:, None])[:, 0]
        ends = zip(*((u.lower, u.upper) for u in self.unknowns), strict=True)
        values = np.clip(moved, *map(np.array, ends))
        return replace(self, solution=replace(self.solution, values=values))

    def correlation(self) -> Floats:
        """Return the correlation of the unknowns by noise alone, shape (p, p), without bounds."""
        return correlation_of(inverse_gram(self.solution.jacobian))

    def with_columns(
        self,
        names: Sequence[tuple[str, int | None, float]],
        columns: Floats,
        most: float = FAR,
    ) -> Self:
        """Return the fit with further free unknowns at zero, by their columns, shape (n, m).

        `names` has the name, the run and the plausible size of each, which is at most `most`.
        """
        solution = self.solution
        further = (Unknown(name, run, 0.0, -most, most, size) for name, run, size in names)
        extended = replace(
            solution,
            values=np.append(solution.values, np.zeros(len(names))),
            at_bound=np.append(solution.at_bound, np.zeros(len(names), bool)),
            jacobian=np.column_stack((solution.jacobian, columns)),
        )
        return replace(self, unknowns=(*self.unknowns, *further), solution=extended)

    def holding(self, names: Collection[str]) -> Self:
        """Return the fit with some unknowns held at their values."""
        free = np.array([u.name not in names for u in self.unknowns])
        solution = replace(
            self.solution,
            values=self.solution.values[free],
            at_bound=self.solution.at_bound[free],
            jacobian=self.solution.jacobian[:, free],
        )
        kept = tuple(u for u in self.unknowns if u.name not in names)
        return replace(self, unknowns=kept, solution=solution)

    def slopes_of(self, unknowns: Sequence[Unknown]) -> Floats:
        """Return the Jacobian by some unknowns, shape (n, p), NaN for those of another fit."""
        columns = {(u.name, u.run): j for j, u in enumerate(self.unknowns)}
        at = [columns.get((u.name, u.run), len(columns)) for u in unknowns]
        other = np.full((self.solution.residual.size, 1), np.nan)
        return np.hstack((self.solution.jacobian, other))[:, at]

    @property
    def solver(self) -> str:
        """The name of the solver."""
        return f"slip chain, {NODES} nodes" if self.on_mesh else "closed form"

    def values(self) -> dict[str, float]:
        """Return the fitted values of the effects' parameters."""
        return {
            u.name: QUANTITIES[u.name].unscaled(v)
            for u, v in zip(self.unknowns, self.solution.values, strict=True)
            if "." in u.name
        }


def correlation_of(covariance: Floats) -> Floats:
    """Return the correlation for a covariance; what does not vary is correlated with nothing."""
    sizes = np.sqrt(np.diag(covariance))
    scale = np.where(sizes > 0.0, sizes, 1.0)
    out: Floats = covariance / np.outer(scale, scale)
    np.fill_diagonal(out, 1.0)
    return out
