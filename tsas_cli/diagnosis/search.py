"""Find the smallest set of effects that no other set improves on held-out runs.

Stepwise selection: one effect after the other is added while the best one is significant; after
each, earlier ones that have become redundant are removed. Where no single effect is significant,
pairs are screened together, because effects of opposite sign mask each other.

What tolerances do is free beside every hypothesis, by its prior: of two effects the one is better
that leaves what every rig has. So is the friction of each run, unless the frictions change with the
session: then they are no scatter.

A running search caches its fits: a set of effects is fitted once, from the initial values of the
path that reaches it first. `tried` returns what it has fitted so far.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from tsas_cli.diagnosis.evidence import (
    LEAST_REDUCTION,
    LEAST_REDUCTION_PER_COMPLEXITY,
    Reduction,
    gain,
)
from tsas_cli.diagnosis.friction_scatter import is_in_line, with_friction_of_runs
from tsas_cli.diagnosis.held_out import Folds, held_out_squares
from tsas_cli.diagnosis.hypotheses import Hypotheses, Names
from tsas_cli.diagnosis.remainder import MOST_SLOW, remainder_of
from tsas_cli.diagnosis.tolerances import tolerances, with_tolerances
from tsas_cli.effects import EFFECTS, Effect
from tsas_cli.identification.extension import TOLERANCE, Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import Screened, least_part, screen_all
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

MOST_EFFECTS = 4
SHARE = 0.2  # least reduction of the excess over the noise by a cause
LEAST = 0.003  # least reduction of the nominal model's excess by a further cause,
MOST = 0.5  # unless it takes that share of what is left
EXCESS_OF_COMPLETE_MODEL = 0.15  # excess of the mean square that a complete model may have
LINEAR = 0.4  # share of its reduction that a signature explains; a fit takes up to 2.5 times it
ATTEMPTS, CLOSER = 4, 0.2  # fits from initial values closer to neutral each time, by that factor
PAIRS = 4  # of effects that are fitted, of those that explain most together


def tried(search: "Search") -> Hypotheses:
    """Return the fits of a search so far, with nothing named."""
    screened = tuple(search.screened.get(frozenset(), ()))
    nothing = frozenset[str]()
    return Hypotheses(
        *(search.bench, search.folds, nothing, {}, screened, search.trials, search.squares)
    )


@dataclass
class Search:
    """A running search: the hypotheses fitted to one dataset so far, with held-out squares."""

    bench: Bench
    folds: Folds
    step: Steps = NO_PROGRESS
    effects: tuple[Effect, ...] = EFFECTS
    trials: dict[tuple[Names, bool], HypothesisFit] = field(default_factory=dict)
    squares: dict[tuple[Names, bool], Floats] = field(default_factory=dict)
    scattered: dict[tuple[Names, bool], Floats] = field(default_factory=dict)  # by own frictions
    in_line: dict[tuple[Names, bool], bool] = field(default_factory=dict)  # own frictions
    screened: dict[Names, list[Screened]] = field(default_factory=dict)
    tolerated: dict[bool, Floats] = field(default_factory=dict)  # at the nominal model, by mesh
    leads: Names = frozenset()
    least: float = math.inf  # held-out squares of what leads

    def run(self) -> Names:
        """Return the effects that are significant together."""
        return self._grown(frozenset(), frozenset())

    def _grown(self, named: Names, before: frozenset[Names]) -> Names:
        """Return the named effects, extended while an effect is significant.

        `before` are the sets on the path. Where a simpler effect is not significantly worse than
        the best one, both branches are searched to their ends: the residual of the simpler effect
        may be one that no further effect explains.
        """
        if len(named) >= MOST_EFFECTS or (named and self.is_quiet(named)) or named in before:
            return named
        ends = [
            self._grown(self._without_redundant(better), before | {named})
            for better in self._better(named)
        ]
        if not ends:
            return named
        simple, best = ends[0], ends[-1]
        return best if self.gain(simple, best).beyond(LEAST_REDUCTION_PER_COMPLEXITY) else simple

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
            trial = self.trial(names, on_mesh=mesh)
            self.in_line[names, mesh] = is_in_line(trial, self.folds.run, session_s)
        return not self.in_line[names, mesh]

    def gain(self, before: Names, after: Names) -> Reduction:
        """Return the reduction between two sets of effects, both on the mesh if one needs it."""
        mesh = self.bench.on_mesh(before | after)
        scatter = self.scatters(before, mesh)
        return gain(
            self.held_out(before, on_mesh=mesh, scatter=scatter),
            self.held_out(after, on_mesh=mesh, scatter=scatter),
        )

    def is_quiet(self, names: Names) -> bool:
        """Return whether noise alone, white or slow, is left with these effects."""
        squares = self.held_out(names, scatter=self.scatters(names, self.bench.on_mesh(names)))
        mean_square = squares.sum() / self.folds.block.size
        if mean_square < 1.0 + EXCESS_OF_COMPLETE_MODEL:
            return True
        return bool(mean_square < 1.0 + MOST_SLOW and self.is_complete(names))

    def is_complete(self, names: Names) -> bool:
        """Return whether a regression finds nothing that a further cause could explain."""
        return remainder_of(self.bench, self.trial(names), self.folds).complete

    def matters(self, before: Names, added: Names) -> bool:
        """Return whether added effects reduce the excess over the noise by a sufficient share."""
        after = before | added
        return self.reduction(before, after) > self.sufficient(before, self.bench.on_mesh(after))

    def reduction(self, before: Names, after: Names) -> float:
        """Return the reduction of the held-out mean square between two sets of effects."""
        mesh = self.bench.on_mesh(before | after)
        scatter = self.scatters(before, mesh)
        return self._excess(before, mesh, scatter) - self._excess(after, mesh, scatter)

    def structure(self, names: Names) -> float:
        """Return the share of the held-out squares with these effects that is more than noise."""
        mesh = self.bench.on_mesh(names)
        excess = max(self._excess(names, mesh, self.scatters(names, mesh)), 0.0)
        return excess / (1.0 + excess)

    def sufficient(self, names: Names, mesh: bool) -> float:
        """Return the reduction of the held-out mean square that a further cause has to make."""
        scatter = self.scatters(names, mesh)
        excess = self._excess(names, mesh, scatter)
        if not names:
            return SHARE * (excess - EXCESS_OF_COMPLETE_MODEL)
        little = LEAST * self._excess(frozenset(), mesh, scatter)
        return max(SHARE * excess, min(little, MOST * excess))

    def add(self, names: Names, least: float = 0.0) -> list[tuple[str, Reduction]]:
        """Return each further effect that passes screening, fitted, with its gain, best first.

        `least` is the reduction of the mean square that the effects have to make.
        """
        screened = self.screen(names)
        part = max(least_part(screened), self._least_part(names, least))
        candidates = [s for s in screened if s.part >= part]
        self.step.ahead(sum(self._is_new(names | {s.effect.name}) for s in candidates))
        found = []
        for s in candidates:
            together = names | {s.effect.name}
            self._fit(names, together, s.initial)
            found.append((s.effect.name, self.gain(names, together)))
        return sorted(found, key=lambda f: -f[1].part)

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

    def _better(self, names: Names) -> list[Names]:
        """Return the extended sets: with the simplest effect, and with the best if it differs."""
        fitted = self.add(names, self.sufficient(names, self.bench.on_mesh(names)))
        singles = [
            (n, g) for n, g in fitted if g.convincing and self.matters(names, frozenset({n}))
        ]
        if singles:
            branches = dict.fromkeys((self._simplest(names, singles), singles[0][0]))
            return [names | {name} for name in branches]
        pair = self._best_pair(names) if len(names) + 2 <= MOST_EFFECTS else None
        return [] if pair is None else [names | pair]

    def _simplest(self, names: Names, singles: list[tuple[str, Reduction]]) -> str:
        """Return the best effect, or one with fewer parameters that is not significantly worse."""
        best = singles[0][0]
        count = {e.name: len(e.parameters) for e in self.effects}
        for name, _ in sorted(singles, key=lambda s: count[s[0]]):
            if count[name] >= count[best]:
                break
            if not self.gain(names | {name}, names | {best}).beyond(LEAST_REDUCTION_PER_COMPLEXITY):
                return name
        return best

    def _best_pair(self, names: Names) -> Names | None:
        """Return two effects that are significant only together."""
        screened = self.screen(names)
        sufficient = self.sufficient(names, self.bench.on_mesh(names))
        least = self._least_part(names, sufficient)
        parts = []
        for a, b in combinations(screened, 2):
            mesh = self.bench.on_mesh([*names, a.effect.name, b.effect.name])
            both = np.hstack((a.signatures, b.signatures))
            residual = self.trial(names, on_mesh=mesh).solution.residual
            basis = np.linalg.qr(both)[0]
            part = float(np.sum((basis.T @ residual) ** 2)) / float(residual @ residual)
            if part >= least:
                parts.append((part - a.part - b.part, a, b))
        parts.sort(key=lambda p: -p[0])
        for surplus, a, b in parts[:PAIRS]:
            if surplus < LEAST_REDUCTION:
                break
            pair = frozenset({a.effect.name, b.effect.name})
            self.step.ahead(self._is_new(names | pair))
            self._fit(names, names | pair, a.initial | b.initial)
            if self.gain(names, names | pair).convincing and self.matters(names, pair):
                return pair
        return None

    def _without_redundant(self, names: Names) -> Names:
        """Return the set without effects that are redundant, removed one by one."""
        for name in sorted(names):
            fewer = names - {name}
            if fewer and not self.gain(fewer, names).convincing:
                return self._without_redundant(fewer)
        return names

    def _excess(self, names: Names, mesh: bool, scatter: bool) -> float:
        """Return by how much the held-out mean square exceeds that of noise alone."""
        squares = self.held_out(names, on_mesh=mesh, scatter=scatter)
        return float(squares.sum()) / self.folds.block.size - 1.0

    def _least_part(self, names: Names, reduction: float) -> float:
        """Return the share of the squares that a signature explains at least, for a reduction."""
        return LINEAR * reduction / self.trial(names).mean_square

    def _is_new(self, names: Names) -> bool:
        """Return whether a set of effects has not been fitted yet."""
        return (names, self.bench.on_mesh(names)) not in self.trials

    def _fit(self, near: Names, names: Names, initial: Mapping[str, float]) -> None:
        if not self._is_new(names):
            return
        mesh = self.bench.on_mesh(names)
        known = self.trial(near, on_mesh=mesh)
        self.step.doing(f"fits {' + '.join(sorted(names))}")
        for _ in range(ATTEMPTS):
            trial = self.bench.fit(sorted(names), initial, near=known, on_mesh=mesh)
            if trial.mean_square <= known.mean_square * (1.0 + TOLERANCE):
                break
            # More free parameters cannot fit worse: the initial values were too far off.
            initial = {n: QUANTITIES[n].closer(v, CLOSER) for n, v in initial.items()}
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
        beside = with_tolerances(trial, self.tolerated[mesh])
        self.squares[names, mesh] = held_out_squares(beside, self.folds)
        scattered = with_friction_of_runs(beside, self.folds.run)
        self.scattered[names, mesh] = held_out_squares(scattered, self.folds)
