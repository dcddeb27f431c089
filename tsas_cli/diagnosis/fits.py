"""The fits of hypotheses to one dataset, each made once, and how well they predict held-out runs.

A set of effects is fitted from the initial values of the path that reaches it first. What
tolerances do is free beside every hypothesis, by its prior: of two effects the one is better that
leaves what every rig has. So is the friction of each run, unless the frictions change with the
session: then they are no scatter. Elastic travel is not: it would take a play that the data show.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from tsas_cli.diagnosis.evidence import Reduction, gain
from tsas_cli.diagnosis.friction_scatter import is_in_line, with_friction_of_runs
from tsas_cli.diagnosis.held_out import Folds, held_out_squares
from tsas_cli.diagnosis.hypotheses import Hypotheses, Names
from tsas_cli.diagnosis.tolerances import (
    tolerances,
    with_scale_and_zeros,
    with_tolerances,
    without_tolerances,
    without_travel,
)
from tsas_cli.effects import EFFECTS, Effect
from tsas_cli.identification.extension import TOLERANCE, Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import Screened, screen_all
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

ATTEMPTS, CLOSER = 4, 0.2  # fits from initial values closer to neutral each time, by that factor


@dataclass
class Fits:
    """The hypotheses fitted to one dataset so far, with their held-out squares."""

    bench: Bench
    folds: Folds
    step: Steps = NO_PROGRESS
    effects: tuple[Effect, ...] = EFFECTS
    trials: dict[tuple[Names, bool], HypothesisFit] = field(default_factory=dict)
    squares: dict[tuple[Names, bool], Floats] = field(default_factory=dict)
    scattered: dict[tuple[Names, bool], Floats] = field(default_factory=dict)  # by own frictions
    in_line: dict[tuple[Names, bool], bool] = field(default_factory=dict)  # own frictions
    screened: dict[Names, list[Screened]] = field(default_factory=dict)
    complete: dict[Names, bool] = field(default_factory=dict)  # whether only noise is left
    taken: dict[Names, float] = field(default_factory=dict)  # shares that tolerances take
    tolerated: dict[bool, Floats] = field(default_factory=dict)  # at the nominal model, by mesh
    leads: Names = frozenset()
    least: float = math.inf  # held-out squares of what leads

    def so_far(self) -> Hypotheses:
        """Return the fits so far, with nothing named."""
        screened = tuple(self.screened.get(frozenset(), ()))
        nothing = frozenset[str]()
        return Hypotheses(
            *(self.bench, self.folds, nothing, {}, screened, self.trials, self.squares)
        )

    def trial(self, names: Names, *, on_mesh: bool = False) -> HypothesisFit:
        """Return the fit of a set of effects, made on the mesh if any of it needs one."""
        mesh = on_mesh or self.bench.on_mesh(names)
        if (names, mesh) not in self.trials:
            near = self.trials.get((names, not mesh))
            self._store(names, self.bench.fit(sorted(names), near=near, on_mesh=mesh))
        return self.trials[names, mesh]

    def held_out(self, names: Names, *, on_mesh: bool = False, scatter: bool = False) -> Floats:
        """Return the held-out squares of a set of effects, block by block.

        With `scatter` each run has a plausible friction of its own.
        """
        trial = self.trial(names, on_mesh=on_mesh)
        return (self.scattered if scatter else self.squares)[names, trial.on_mesh]

    def scatters(self, names: Names, mesh: bool) -> bool:
        """Return whether the frictions of the runs beside a set of effects are mere scatter."""
        if (names, mesh) not in self.in_line:
            session_s = np.array([run.run.session_s for run in self.bench.closed])
            bends_rad = np.array([rig.total_bend_rad for rig in self.bench.rigs])
            trial = self.trial(names, on_mesh=mesh)
            lines = [session_s, *([1.0 / bends_rad] if bends_rad.all() else [])]
            self.in_line[names, mesh] = any(is_in_line(trial, self.folds.run, x) for x in lines)
        return not self.in_line[names, mesh]

    def gain(self, before: Names, after: Names) -> Reduction:
        """Return the reduction between two sets of effects, both on the mesh if one needs it."""
        mesh = self.bench.on_mesh(before | after)
        scatter = self.scatters(before, mesh)
        return gain(
            self.held_out(before, on_mesh=mesh, scatter=scatter),
            self.held_out(after, on_mesh=mesh, scatter=scatter),
        )

    def reduction(self, before: Names, after: Names) -> float:
        """Return the reduction of the held-out mean square between two sets of effects."""
        mesh = self.bench.on_mesh(before | after)
        scatter = self.scatters(before, mesh)
        return self.excess(before, mesh, scatter) - self.excess(after, mesh, scatter)

    def structure(self, names: Names) -> float:
        """Return the share of the held-out squares with these effects that is more than noise."""
        mesh = self.bench.on_mesh(names)
        excess = max(self.excess(names, mesh, self.scatters(names, mesh)), 0.0)
        return excess / (1.0 + excess)

    def of_tolerances(self, names: Names) -> float:
        """Return the share of the squares with these effects that tolerances take away."""
        if names not in self.taken:
            trial = self.trial(names)
            tolerated = with_scale_and_zeros(self.bench, trial, self.tolerated[trial.on_mesh])
            left = without_tolerances(trial, tolerated, self.folds.run)
            self.taken[names] = 1.0 - float(left @ left) / float(np.sum(trial.solution.residual**2))
        return self.taken[names]

    def excess(self, names: Names, mesh: bool, scatter: bool) -> float:
        """Return by how much the held-out mean square exceeds that of noise alone."""
        squares = self.held_out(names, on_mesh=mesh, scatter=scatter)
        return float(squares.sum()) / self.folds.block.size - 1.0

    def screen(self, names: Names) -> list[Screened]:
        """Return all further effects screened linearly, the one that explains most first."""
        if names not in self.screened:
            near = min(self.screened, key=lambda other: len(other ^ names), default=None)
            known = () if near is None else self.screened[near]
            further = {
                effect: self.trial(names, on_mesh=self.bench.on_mesh([*names, effect.name]))
                for effect in self.effects
                if effect.name not in names
            }
            beside = f" beside {', '.join(sorted(names))}" if names else ""
            self.step.doing(f"screens {len(further)} effects{beside}")
            self.screened[names] = screen_all(self.bench, further, known, self.step)
        return self.screened[names]

    def is_new(self, names: Names) -> bool:
        """Return whether a set of effects has not been fitted yet."""
        return (names, self.bench.on_mesh(names)) not in self.trials

    def fit(self, near: Names, names: Names, *screened: Screened) -> None:
        """Fit a set of effects if it is new, from another one and effects screened beside it."""
        if not self.is_new(names):
            return
        mesh = self.bench.on_mesh(names)
        known = self.trial(near, on_mesh=mesh)
        initial = {name: value for s in screened for name, value in s.initial.items()}
        change = np.sum([s.change for s in screened], axis=0)
        self.step.doing(f"fits {' + '.join(sorted(names))}")
        for _ in range(ATTEMPTS):
            start = known.ready_for(change)
            trial = self.bench.fit(sorted(names), initial, near=start, on_mesh=mesh)
            if trial.mean_square <= known.mean_square * (1.0 + TOLERANCE):
                break
            # More free parameters cannot fit worse: the initial values were too far off.
            initial = {n: QUANTITIES[n].closer(v, CLOSER) for n, v in initial.items()}
            change = CLOSER * change
        self._store(names, trial)
        self._say_leader(names)
        self.step()

    def _say_leader(self, names: Names) -> None:
        """Say what leads if it is this set: the one with the least held-out squares."""
        mesh, nothing = self.bench.on_mesh(names), frozenset[str]()
        left = float(self.squares[names, mesh].sum())
        if left >= self.least:
            return
        self.leads, self.least = names, left
        nominal = self.squares.get((nothing, mesh), self.squares[nothing, self.bench.on_mesh(())])
        reduction = 100.0 * (1.0 - math.sqrt(left / float(nominal.sum())))
        if reduction > 0.0:
            effects = " + ".join(sorted(names))
            self.step.say(f"{effects} leads so far: reduction about {reduction:.0f} %")

    def _store(self, names: Names, trial: HypothesisFit) -> None:
        mesh = trial.on_mesh
        self.trials[names, mesh] = trial
        if not names:
            self.tolerated[mesh] = tolerances(self.bench, trial)
        elif mesh not in self.tolerated:
            self.trial(frozenset(), on_mesh=mesh)
        beside = with_tolerances(trial, without_travel(self.tolerated[mesh]))
        self.squares[names, mesh] = held_out_squares(beside, self.folds)
        scattered = with_friction_of_runs(beside, self.folds.run)
        self.scattered[names, mesh] = held_out_squares(scattered, self.folds)
