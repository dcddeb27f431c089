"""The joint fit of the nominal parameters to all runs and all their measured channels.

`solve_fit` solves the problem of `fit_problem` without changing it. The Jacobian determines which
parameters are identifiable; the others are fixed. The residuals and their weights are those of
`run_errors`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import (
    Fitted,
    Residuals,
    Unknown,
    identifiable,
    jacobian,
    solve,
    with_errors,
)
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.fit_sentences import doubts_of, fixed_sentences
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES, Quantity
from tsas_cli.identification.run_errors import RunErrors, blocks_of, reweighted
from tsas_cli.numerics.side_by_side import each
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

MOST_ROUNDS = 4
WRONG_RATIO = 1.3  # normalised residual beyond which the model is wrong
ROUGH, FINE = 1e-3, 1e-6  # tolerance of the first fit, with initial weights, and of later ones


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A solved joint fit.

    `values` are the scaled values of all unknowns, (p,), `chosen` the indices of those that were
    fitted, `errors` the residuals of the runs, weighted at these values. `fitted` is None where no
    parameter is identifiable; `model` is then the fixed one. `not_identifiable` has the fixed
    parameters with the reason, `doubts` the unreliable estimates, in sentences.
    """

    problem: FitProblem
    values: Floats
    chosen: tuple[int, ...]
    errors: tuple[RunErrors, ...]
    model: Model
    fitted: Fitted | None
    not_identifiable: tuple[str, ...]
    doubts: tuple[str, ...] = ()

    @property
    def free(self) -> list[Unknown]:
        """The free parameters: those that are identifiable."""
        return [self.problem.unknowns[j] for j in self.chosen]

    @property
    def rigs(self) -> list[Rig]:
        """The rig of each run."""
        return [self.problem.rig(k, self.values) for k in range(len(self.problem.runs))]

    @property
    def cannot_tell(self) -> list[str]:
        """Sentences on what these recordings do not determine, and why."""
        return [*self.not_identifiable, *self.doubts]


def solve_fit(problem: FitProblem) -> FittedModel:
    """Return the fit of the identifiable parameters, iterated with new weights until they stay."""
    unknowns, errors = problem.unknowns, problem.errors
    values = np.array([u.initial for u in unknowns])
    if not problem.runs:
        return FittedModel(problem, values, (), errors, problem.fixed, None, problem.left_out)
    before: list[int] = []
    lost: set[int] = set()
    for _ in range(MOST_ROUNDS):
        start = _finite(values, unknowns)
        J = jacobian(unknowns, len(problem.runs), start, _residuals(problem, errors))
        chosen, confounded = identifiable(unknowns, J)
        # A fitted parameter whose value is too small to be sensitive is identifiable as small. A
        # zero that has run to its bound is not identifiable: the fit gains by forgetting it.
        small = [j for j in before if confounded.get(j) == []]
        chosen = sorted({*chosen, *small} - lost)
        others = {j: p for j, p in confounded.items() if j not in small} | {j: [] for j in lost}
        fixed = fixed_sentences(problem, others)
        notes = (*problem.left_out, *fixed)
        if not chosen:
            return FittedModel(problem, values, (), errors, problem.fixed, None, notes)
        fitted = _fit(problem, errors, values, chosen, tolerance=FINE if before else ROUGH)
        values = _fixed_values(problem)
        values[chosen] = fitted.values
        lost |= {
            j
            for j, at_bound in zip(chosen, fitted.at_bound, strict=True)
            if at_bound
            and not QUANTITIES[unknowns[j].name].positive
            and unknowns[j].lower < 0.0 < unknowns[j].upper
        }
        errors = tuple(reweighted(e, problem.rig(k, values)) for k, e in enumerate(errors))
        if chosen == before and not lost & set(chosen):
            break
        before = chosen
    estimates = estimates_of([unknowns[j] for j in chosen], fitted, problem.ids)
    model = Model(tuple(estimates)).over(problem.fixed)
    doubts = tuple(doubts_of(estimates, fitted))
    return FittedModel(problem, values, tuple(chosen), errors, model, fitted, notes, doubts)


def misfit(fit: FittedModel) -> list[str]:
    """Return a sentence on the channels whose residual exceeds its known uncertainty, if any."""
    worst: dict[str, float] = {}
    for run, rig in zip(fit.errors, fit.rigs, strict=True):
        for name, errors in run.errors(rig).items():
            worst[name] = max(worst.get(name, 0.0), float(np.mean(errors**2)))
    wrong = [f"{x:.3g} for {name}" for name, x in worst.items() if x > WRONG_RATIO**2]
    said = (
        f"The reduced chi-square is up to {listed(wrong)} (1 at the noise level): the nominal "
        "model lacks an effect, or load cells, bend or friction are off by their tolerances "
        "(`tsas diagnose` says which). The estimates are those of the nearest nominal model."
    )
    return [said] if wrong else []


def residuals_with(fit: FittedModel, changes: Mapping[str, float]) -> Floats:
    """Return the residuals of all runs at a fitted model with some shared values changed."""
    changed = [with_values(rig, changes) for rig in fit.rigs]
    pairs = zip(fit.errors, changed, strict=True)
    return np.concatenate(each(lambda pair: pair[0].residuals(pair[1]), list(pairs)))


def slopes_of_free(fit: FittedModel) -> Floats:
    """Return the Jacobian of the residuals by the free parameters, shape (n, p)."""
    problem, chosen = fit.problem, list(fit.chosen)
    residuals = _of_free(_residuals(problem, fit.errors), fit.values, chosen)
    return jacobian(fit.free, len(problem.runs), fit.values[chosen], residuals)


def moved_model(fit: FittedModel, moves: Floats) -> Model:
    """Return initial values for another fit: the fitted ones, the free ones moved by a step."""
    at = fit.values.copy()
    at[list(fit.chosen)] += moves
    moved = [
        Estimate(
            u.name,
            QUANTITIES[u.name].unscaled(float(np.clip(v, u.lower, u.upper))),
            QUANTITIES[u.name].unit,
            "default",
            fit.problem.owner(u),
        )
        for u, v in zip(fit.problem.unknowns, at, strict=True)
        if np.isfinite(v)
    ]
    return Model(tuple(moved)).over(fit.problem.initial)


def _finite(values: Floats, unknowns: Sequence[Unknown]) -> Floats:
    """Return the values, with the initial one in place of NaN (critical damping)."""
    return np.where(np.isnan(values), [u.initial for u in unknowns], values)


def _residuals(problem: FitProblem, errors: Sequence[RunErrors]) -> Residuals:
    return lambda k, values: errors[k].residuals(problem.rig(k, values))


def _of_free(residuals: Residuals, fixed: Floats, free: list[int]) -> Residuals:
    """Return residuals at values of the free unknowns, by their indices, the others fixed."""

    def of_free(k: int, values: Floats) -> Floats:
        at = fixed.copy()
        at[free] = values
        return residuals(k, at)

    return of_free


def _fit(
    problem: FitProblem,
    errors: Sequence[RunErrors],
    values: Floats,
    chosen: list[int],
    *,
    tolerance: float,
) -> Fitted:
    """Return the fit of the chosen unknowns from their values, the others fixed.

    Far from the noise the squares may fall by little for many steps. A fit that does not converge
    goes on until a step takes less than the tolerance of the noise's squares, `ROUGH` of its own at
    most.
    """
    start = _finite(values, problem.unknowns)
    free = [replace(problem.unknowns[j], initial=float(start[j])) for j in chosen]
    blocks = blocks_of(errors, [problem.rig(k, values) for k in range(len(errors))])
    residuals = _of_free(_residuals(problem, errors), _fixed_values(problem), chosen)
    found = solve(free, len(blocks), residuals, tolerance=tolerance)
    if not found.converged:
        mean_square = float(np.mean(found.residual**2))
        free = [replace(u, initial=float(v)) for u, v in zip(free, found.values, strict=True)]
        rougher = min(tolerance * max(mean_square, 1.0), ROUGH)
        found = solve(free, len(blocks), residuals, tolerance=rougher)
    return with_errors(free, found, blocks)


def _fixed_values(problem: FitProblem) -> Floats:
    out = []
    for unknown in problem.unknowns:
        value = problem.fixed.value(unknown.name, problem.owner(unknown))
        quantity = QUANTITIES[unknown.name]
        out.append(quantity.scaled(quantity.default if value is None else value))
    return np.array(out)


def estimates_of(
    unknowns: Sequence[Unknown],
    found: Fitted,
    runs: Sequence[str],
    quantities: Mapping[str, Quantity] = QUANTITIES,
) -> list[Estimate]:
    """Return the estimates of a fit's unknowns, in their units; `runs` are the ids of the runs."""
    out = []
    each_one = zip(unknowns, found.values, found.stderr, found.t, found.at_bound, strict=True)
    for u, v, sd, t, at_bound in each_one:
        quantity = quantities[u.name]
        ends = np.clip([v - t * sd, v, v + t * sd], u.lower, u.upper)
        low, value, high = (quantity.inside(float(end)) for end in ends)
        stderr = sd * (value if quantity.positive else quantity.size)
        out.append(
            Estimate(
                u.name,
                value,
                quantity.unit,
                "fitted",
                None if u.run is None else runs[u.run],
                float(stderr) if np.isfinite(stderr) else None,
                low,
                high,
                bool(at_bound),
            )
        )
    return out
