"""Find the smallest set of effects that no other set beats on held-out runs.

One effect after the other is added while the best one convinces; after each, every earlier one
has to prove itself again without the others' help. Where single effects leave something, pairs
are looked at together, because effects of opposite sign hide each other.

`find_effects` gives what a search has found. While it is at work, a `Search` holds the fits made so
far: a set of effects is fitted once, from the initial values of the way that reaches it first.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.evidence import APART, RICHER, TELLING, Gain, gain
from tsas_cli.diagnosis.held_out import Folds, held_out_squares
from tsas_cli.effects import EFFECTS, Effect
from tsas_cli.identification.extension import TOLERANCE, Bench, Trial, reweighed_bench
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import Screened, projector, screen
from tsas_cli.support.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]
Names = frozenset[str]

MOST_EFFECTS = 4
SHARE = 0.4  # of what is beyond the noise, that a cause has to take away
LEAST = 0.003  # of what the nominal model was beyond it, that a further cause has to take away
BLURRED = 0.15  # mean square by which a model that lacks nothing may miss the noise it is held to
WORTH = 0.0005  # part of the squares that a signature has to explain to be fitted
BESIDE_BEST = 0.02  # of what the best signature explains
ATTEMPTS, CLOSER = 4, 0.2
WEIGHED = 3  # times that the errors are weighed by what was found, and it is fitted again
PAIRS = 4  # that are fitted, of those that explain most together


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """What a search has found: the effects named, their rivals, and every fit behind them.

    `trials` and `squares` hold each set of effects that was fitted, off and on the mesh, with its
    held-out squares by block, `screened` all effects as seen with nothing named.
    """

    bench: Bench
    folds: Folds
    named: Names
    rivals: Mapping[str, tuple[str, ...]]
    screened: tuple[Screened, ...]
    trials: Mapping[tuple[Names, bool], Trial]
    squares: Mapping[tuple[Names, bool], Floats]

    def trial(self, names: Names, *, on_mesh: bool = False) -> Trial:
        """Return the fit of a set of effects, that on the mesh if any of it needs one."""
        return self.trials[names, on_mesh or self.bench.on_mesh(names)]

    def held_out(self, names: Names, *, on_mesh: bool = False) -> Floats:
        """Return the held-out squares of a set of effects, block by block."""
        return self.squares[names, on_mesh or self.bench.on_mesh(names)]

    def gain(self, names: Names) -> Gain:
        """Compare a set of effects with nothing named, both on the mesh if it needs one."""
        mesh = self.bench.on_mesh(names)
        return gain(self.held_out(frozenset(), on_mesh=mesh), self.held_out(names))


def find_effects(bench: Bench, folds: Folds, step: Steps = SILENT) -> Hypotheses:
    """Return the effects that are convincing together, and what else was tried."""
    search = Search(bench, folds, step)
    named = search.run()
    rivals = {e.name: search.rivals(named, e.name) for e in EFFECTS if e.name in named}
    screened = tuple(search.screen(frozenset()))
    for names in _judged_sets(named):
        search.trial(names, on_mesh=bench.on_mesh(named))
    return Hypotheses(bench, folds, named, rivals, screened, search.trials, search.squares)


def weighed_again(found: Hypotheses, step: Steps = SILENT) -> Hypotheses:
    """Return the fits of what is named, of nothing, and of all but one, weighed by what is named.

    Rivals and signatures stay those that were found.
    """
    named, bench = found.named, found.bench
    mesh, trial = bench.on_mesh(named), found.trial(named)
    sets = _judged_sets(named)
    step.ahead(WEIGHED + len(sets))
    for _ in range(WEIGHED):
        bench = reweighed_bench(bench, trial)
        trial = bench.fit(sorted(named), near=trial, on_mesh=mesh)
        step()
    trials = {}
    for names in sets:
        near = found.trial(names, on_mesh=mesh)
        trials[names, mesh] = bench.fit(sorted(names), near=near, on_mesh=mesh)
        step()
    squares = {key: held_out_squares(trial, found.folds) for key, trial in trials.items()}
    return replace(found, bench=bench, trials=trials, squares=squares)


def _judged_sets(named: Names) -> set[Names]:
    """Return what is named, nothing, and all but one."""
    return {frozenset[str](), named, *(named - {name} for name in named)}


@dataclass
class Search:
    """A search at work: the hypotheses fitted to one dataset so far, with held-out squares."""

    bench: Bench
    folds: Folds
    step: Steps = SILENT
    effects: tuple[Effect, ...] = EFFECTS
    trials: dict[tuple[Names, bool], Trial] = field(default_factory=dict)
    squares: dict[tuple[Names, bool], Floats] = field(default_factory=dict)
    screened: dict[Names, list[Screened]] = field(default_factory=dict)

    def run(self) -> Names:
        """Return the effects that are convincing together."""
        return self._grown(frozenset(), frozenset())

    def _grown(self, named: Names, before: frozenset[Names]) -> Names:
        """Add to the named effects while something convinces; `before` holds the sets passed.

        Where a simpler effect is not worse than the best one by enough, both ways are gone to
        their ends: what a simpler effect leaves may be what nothing else explains.
        """
        if len(named) >= MOST_EFFECTS or (named and self.is_quiet(named)) or named in before:
            return named
        ends = [
            self._grown(self._without_idle(better), before | {named})
            for better in self._better(named)
        ]
        if not ends:
            return named
        simple, best = ends[0], ends[-1]
        return best if self.gain(simple, best).beyond(RICHER) else simple

    def rivals(self, named: Names, name: str) -> tuple[str, ...]:
        """Return the effects that would do as well in place of a named one."""
        fewer = named - {name}
        out = []
        for other, found in self.add(fewer):
            instead = fewer | {other}
            if other in named or not found.convincing:
                continue
            if self.trial(instead).solution.converged and not self.gain(instead, named).beyond(
                APART
            ):
                out.append(other)
        return tuple(out)

    def trial(self, names: Names, *, on_mesh: bool = False) -> Trial:
        """Return the fit of a set of effects, made on the mesh if any of it needs one."""
        mesh = on_mesh or self.bench.on_mesh(names)
        if (names, mesh) not in self.trials:
            near = self.trials.get((names, not mesh))
            self._keep(names, self.bench.fit(sorted(names), near=near, on_mesh=mesh))
        return self.trials[names, mesh]

    def held_out(self, names: Names, *, on_mesh: bool = False) -> Floats:
        """Return the held-out squares of a set of effects, block by block."""
        trial = self.trial(names, on_mesh=on_mesh)
        return self.squares[names, trial.on_mesh]

    def gain(self, before: Names, after: Names) -> Gain:
        """Compare two sets of effects, both on the mesh if one needs it."""
        mesh = self.bench.on_mesh(before | after)
        return gain(self.held_out(before, on_mesh=mesh), self.held_out(after, on_mesh=mesh))

    def is_quiet(self, names: Names) -> bool:
        """Say whether so little is left that a further cause could not be told from blur."""
        return bool(self.held_out(names).sum() / self.folds.block.size < 1.0 + BLURRED)

    def matters(self, before: Names, added: Iterable[str]) -> bool:
        """Say whether effects take away a good share of what was beyond the noise before."""
        mesh = self.bench.on_mesh(before | set(added))
        excess = [
            self.held_out(names, on_mesh=mesh).sum() / self.folds.block.size - 1.0
            for names in (before, before | set(added))
        ]
        saved = excess[0] - excess[1]
        if not before:
            return bool(saved > SHARE * (excess[0] - BLURRED))
        first = self.held_out(frozenset(), on_mesh=mesh).sum() / self.folds.block.size - 1.0
        return bool(saved > max(SHARE * excess[0], LEAST * first))

    def add(self, names: Names) -> list[tuple[str, Gain]]:
        """Fit each further effect that is worth it; return them with their gains, best first."""
        seen = self.screen(names)
        best = max((s.part for s in seen), default=0.0)
        worth = [s for s in seen if s.part >= max(WORTH, BESIDE_BEST * best)]
        self.step.ahead(sum(self._is_new(names | {s.effect.name}) for s in worth))
        found = []
        for s in worth:
            together = names | {s.effect.name}
            self._fit(names, together, s.initial)
            found.append((s.effect.name, self.gain(names, together)))
        return sorted(found, key=lambda f: -f[1].part)

    def screen(self, names: Names) -> list[Screened]:
        """Look at all further effects linearly, the one that explains most first."""
        if names not in self.screened:
            bases = {}
            out = []
            further = [effect for effect in self.effects if effect.name not in names]
            self.step.ahead(len(further))
            for effect in further:
                mesh = self.bench.on_mesh([*names, effect.name])
                trial = self.trial(names, on_mesh=mesh)
                if mesh not in bases:
                    bases[mesh] = projector(trial)
                out.append(screen(self.bench, trial, effect, bases[mesh]))
                self.step()
            self.screened[names] = sorted(out, key=lambda s: -s.part)
        return self.screened[names]

    def _better(self, names: Names) -> list[Names]:
        """Return the sets to go on with: with a simple effect, with the best one if it differs."""
        singles = [(n, g) for n, g in self.add(names) if g.convincing and self.matters(names, {n})]
        if singles:
            ways = dict.fromkeys((self._simplest(names, singles), singles[0][0]))
            return [names | {name} for name in ways]
        pair = self._best_pair(names) if len(names) + 2 <= MOST_EFFECTS else None
        return [] if pair is None else [names | pair]

    def _simplest(self, names: Names, singles: list[tuple[str, Gain]]) -> str:
        """Return the best effect, or one with fewer parameters that it does not beat."""
        best = singles[0][0]
        count = {e.name: len(e.parameters) for e in self.effects}
        for name, _ in sorted(singles, key=lambda s: count[s[0]]):
            if count[name] >= count[best]:
                break
            if not self.gain(names | {name}, names | {best}).beyond(RICHER):
                return name
        return best

    def _best_pair(self, names: Names) -> Names | None:
        """Return two effects that are convincing only together."""
        seen = self.screen(names)
        parts = []
        for a, b in combinations(seen, 2):
            mesh = self.bench.on_mesh([*names, a.effect.name, b.effect.name])
            both = np.hstack((a.signatures, b.signatures))
            residual = self.trial(names, on_mesh=mesh).solution.residual
            basis = np.linalg.qr(both)[0]
            part = float(np.sum((basis.T @ residual) ** 2)) / float(residual @ residual)
            parts.append((part - a.part - b.part, a, b))
        parts.sort(key=lambda p: -p[0])
        for surplus, a, b in parts[:PAIRS]:
            if surplus < TELLING:
                break
            pair = frozenset({a.effect.name, b.effect.name})
            self.step.ahead(self._is_new(names | pair))
            self._fit(names, names | pair, a.initial | b.initial)
            if self.gain(names, names | pair).convincing and self.matters(names, pair):
                return pair
        return None

    def _without_idle(self, names: Names) -> Names:
        """Leave out, one by one, what the others do not need."""
        for name in sorted(names):
            fewer = names - {name}
            if fewer and not self.gain(fewer, names).convincing:
                return self._without_idle(fewer)
        return names

    def _is_new(self, names: Names) -> bool:
        """Say whether a set of effects has not been fitted yet."""
        return (names, self.bench.on_mesh(names)) not in self.trials

    def _fit(self, near: Names, names: Names, initial: Mapping[str, float]) -> None:
        if not self._is_new(names):
            return
        mesh = self.bench.on_mesh(names)
        known = self.trial(near, on_mesh=mesh)
        for _ in range(ATTEMPTS):
            trial = self.bench.fit(sorted(names), initial, near=known, on_mesh=mesh)
            if trial.mean_square <= known.mean_square * (1.0 + TOLERANCE):
                break
            # More freedom cannot fit worse: the initial values were too far off.
            initial = {n: QUANTITIES[n].closer(v, CLOSER) for n, v in initial.items()}
        self._keep(names, trial)
        self.step()

    def _keep(self, names: Names, trial: Trial) -> None:
        self.trials[names, trial.on_mesh] = trial
        self.squares[names, trial.on_mesh] = held_out_squares(trial, self.folds)
