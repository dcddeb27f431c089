"""The calibrated runs with effects freed: every hypothesis is fitted in the same way."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from tsas_cli.identification.fit import Unknown, solve
from tsas_cli.identification.fit_problem import rig_at, unknown_of
from tsas_cli.identification.hypothesis_fit import NODES, HypothesisFit
from tsas_cli.identification.joint_fit import FittedModel
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.run_errors import RunErrors, meshed, reweighted
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.numerics.side_by_side import each
from tsas_cli.physics.response import ON_CHAIN, is_closed
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.support.arrays import Floats

TOLERANCE = 1e-5  # of the squares, for the last step of a fit that is one of many
MOST_LOOSENING = 100.0  # of TOLERANCE, in proportion to the mean square of the residuals
COARSE_NODES, COARSE_PER_MEAN = 12, 2.0  # of the slip chain
PROBED = (0.1, 0.3)  # of its plausible size, where a size that ended at its bound is tried again


@dataclass(frozen=True, eq=False)
class Bench:
    """A calibrated dataset on which hypotheses are fitted.

    `free` are the free parameters of the base fit, with its estimates as initial values, `rigs`
    those of its runs. The residuals of the runs, with the weights and samples of the base fit, are
    `closed` by the solver that each rig needs, `meshed` by the slip chain, `coarse` by one of which
    only differences are meaningful. `priors` are those of effects' parameters that have one
    (`Unknown.prior`); `tolerance` is the share of the squares for the last step of a fit, in
    proportion to their mean beyond the noise.
    """

    base: FittedModel
    rigs: tuple[Rig, ...]
    free: tuple[Unknown, ...]
    closed: tuple[RunErrors, ...]
    meshed: tuple[RunErrors, ...]
    coarse: tuple[RunErrors, ...]
    never_closed: bool
    priors: Mapping[str, float] = field(default_factory=dict)
    tolerance: float = TOLERANCE

    def on_mesh(self, effects: Iterable[str]) -> bool:
        """Return whether a hypothesis needs the slip chain."""
        return self.never_closed or any(name in ON_CHAIN for name in effects)

    def fit(
        self,
        effects: Sequence[str] = (),
        initial: Mapping[str, float] | None = None,
        *,
        near: HypothesisFit | None = None,
        on_mesh: bool = False,
        values_only: bool = False,
    ) -> HypothesisFit:
        """Return a fit of the free parameters of the base fit and those of the effects.

        Parameters
        ----------
        effects
            The effects that are freed.
        initial
            Initial values of their parameters, in their units; else those of `near`, else each
            parameter's own.
        near
            A trial with the initial values and slopes of the others.
        on_mesh
            Whether to use the slip chain even where the closed form is valid.
        values_only
            Whether the Jacobian of the fit may be rough.
        """
        known = {} if near is None else {(u.name, u.run): float(v) for u, v in _pairs(near)}
        base = [replace(u, initial=known.get((u.name, u.run), u.initial)) for u in self.free]
        freed = []
        has_force = any(errors.run.has_force for errors in self.closed)
        for name in _parameters(effects, has_force=has_force):
            quantity = QUANTITIES[name]
            value = known.get((name, None))
            if initial is not None and name in initial:
                value = quantity.scaled(initial[name])
            freed.append(replace(unknown_of(name, value), prior=self.priors.get(name, 0.0)))
        unknowns = (*base, *freed)
        mesh = on_mesh or self.on_mesh(effects)
        runs = len(self.rigs)
        tolerance = self.tolerance_at(1.0 if near is None else near.mean_square)
        fine, coarse = (self.meshed, self.coarse) if mesh else (self.closed, self.closed)

        def residuals(errors: Sequence[RunErrors], k: int, values: Floats) -> Floats:
            return errors[k].residuals(rig_at(self.rigs[k], k, unknowns, values))

        solved = partial(
            solve,
            runs=runs,
            residuals=partial(residuals, fine),
            differing=partial(residuals, coarse),
            tolerance=tolerance,
            values_only=values_only,
        )
        solution = solved(unknowns, known=None if near is None else near.slopes_of(unknowns))
        inside = off_bounds(
            unknowns,
            solution,
            lambda values: np.concatenate(each(lambda k: residuals(fine, k, values), range(runs))),
        )
        if inside is not None:
            solution = solved(inside, known=solution.jacobian)
        sizes = tuple(run.count for run in fine)
        return HypothesisFit(tuple(effects), unknowns, solution, sizes, mesh)

    def tolerance_at(self, mean_square: float) -> float:
        """Return the share of the squares below which a step is the last, by their mean."""
        return self.tolerance * min(max(mean_square, 1.0), MOST_LOOSENING)

    def errors_at(self, trial: HypothesisFit, changes: Mapping[str, float]) -> Floats:
        """Return all residuals at a trial's values with some effects' parameters set.

        For screening: on the coarse mesh, where one is needed.
        """
        unknowns = [*trial.unknowns, *(unknown_of(name) for name in changes)]
        scaled = [QUANTITIES[name].scaled(value) for name, value in changes.items()]
        at = np.concatenate((trial.solution.values, scaled))
        errors = self.coarse if trial.on_mesh else self.closed

        def residuals(k: int) -> Floats:
            return errors[k].residuals(rig_at(self.rigs[k], k, unknowns, at))

        return np.concatenate(each(residuals, range(len(errors)), at_once=trial.on_mesh))

    def changes_on_chain(
        self, trial: HypothesisFit, settings: Sequence[Mapping[str, float]]
    ) -> Floats:
        """Return how a trial's residuals change by settings that only the slip chain has, (n, m).

        Each setting holds values of a rig by name (`with_values`).
        """
        parts = []
        for k, run in enumerate(self.meshed):
            rig = self.rig(trial, k)
            plain = run.residuals(rig)
            parts.append(np.array([run.residuals(with_values(rig, s)) - plain for s in settings]).T)
        return np.concatenate(parts)

    @property
    def channels(self) -> list[str]:
        """The compared channels, in a fixed order."""
        return sorted({name for run in self.closed for name in run.samples})

    @cached_property
    def by_driven_ends(self) -> list[dict[str, Floats]]:
        """What noise of the driven ends does to each channel, run by run (`RunErrors`)."""
        runs = range(len(self.closed))
        return each(lambda k: self.closed[k].by_driven_ends(self.rigs[k]), runs)

    @property
    def longest_stroke_mm(self) -> float:
        """The longest way of the drive in a run, infinite where no displacement drives one."""
        strokes = [
            float(np.ptp(run.run.conditioned["x_in_mm"].values))
            for run in self.closed
            if "x_in_mm" in run.run.conditioned
        ]
        return max(strokes, default=math.inf)

    @property
    def sample_interval_s(self) -> float:
        """The longest usual time between two samples of a run."""
        return max(float(np.median(np.diff(errors.run.time_s))) for errors in self.closed)

    def errors_for(self, trial: HypothesisFit) -> tuple[RunErrors, ...]:
        """Return the residual functions of the runs for a trial's solver."""
        return self.meshed if trial.on_mesh else self.closed

    def rig(self, trial: HypothesisFit, k: int) -> Rig:
        """Return the rig of run k with a trial's values."""
        return rig_at(self.rigs[k], k, trial.unknowns, trial.solution.values)


def off_bounds(
    unknowns: Sequence[Unknown], solution: Solution, residuals: Callable[[Floats], Floats]
) -> list[Unknown] | None:
    """Return initial values with a size that ended at its bound where the squares are smaller.

    None where there are none. The squares need not fall from the bound on: a play that is smaller
    than what else is wrong begins with a hill.
    """
    best, least = None, float(solution.residual @ solution.residual)
    for j in np.flatnonzero(solution.at_bound).tolist():
        quantity = QUANTITIES[unknowns[j].name]
        neutral = quantity.scaled(quantity.default)
        if "." not in quantity.name or quantity.shape or solution.values[j] != neutral:
            continue
        side = 1.0 if unknowns[j].upper > neutral else -1.0
        for part in PROBED:
            tried = solution.values.copy()
            tried[j] += side * part
            errors = residuals(tried)
            if float(errors @ errors) < least:
                best, least = tried, float(errors @ errors)
    if best is None:
        return None
    return [replace(u, initial=float(v)) for u, v in zip(unknowns, best, strict=True)]


def bench_of(base: FittedModel) -> Bench:
    """Return the bench of a base fit."""
    errors, unknowns = base.errors, base.problem.unknowns
    rigs = tuple(base.rigs)
    closed = (is_closed(rig, e.simulation.drive) for rig, e in zip(rigs, errors, strict=True))
    return Bench(
        base,
        rigs,
        tuple(replace(unknowns[j], initial=float(base.values[j])) for j in base.chosen),
        errors,
        tuple(meshed(e, NODES) for e in errors),
        tuple(meshed(e, COARSE_NODES, COARSE_PER_MEAN) for e in errors),
        not all(closed),
    )


def reweighted_bench(bench: Bench, trial: HypothesisFit) -> Bench:
    """Return a bench with the residuals weighted at a trial's model."""
    runs = range(len(bench.closed))
    errors = tuple(each(lambda k: reweighted(bench.closed[k], bench.rig(trial, k)), runs))
    return replace(
        bench,
        closed=errors,
        meshed=tuple(meshed(e, NODES) for e in errors),
        coarse=tuple(meshed(e, COARSE_NODES, COARSE_PER_MEAN) for e in errors),
    )


def _pairs(trial: HypothesisFit) -> list[tuple[Unknown, float]]:
    return list(zip(trial.unknowns, trial.solution.values, strict=True))


def _parameters(effects: Sequence[str], *, has_force: bool) -> list[str]:
    """Return the parameters of effects that are fitted; those of forces only where one is known."""
    return [
        name
        for name, quantity in QUANTITIES.items()
        if name.split(".")[0] in effects
        and "." in name
        and not quantity.given
        and (has_force or not quantity.of_forces)
    ]
