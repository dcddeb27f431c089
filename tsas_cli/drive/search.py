"""Which lags and which hidden effects a drive has: full fits of all, judged on held-out data.

All sixteen structures of G(s) are fitted; the simplest one is taken that the best does not surely
beat. Where it leaves more than noise, ripple and play are tried on top, and with what convinces
the structure is chosen again, since lags imitate play and the other way round.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from tsas_cli.diagnosis.evidence import (
    LEAST_DIFFERENCE,
    LEAST_REDUCTION_PER_COMPLEXITY,
    Reduction,
    gain,
)
from tsas_cli.diagnosis.held_out import STRETCHES, Folds, held_out_squares
from tsas_cli.diagnosis.search import EXCESS_OF_COMPLETE_MODEL
from tsas_cli.drive.fit import LINEAR, DriveBench, DriveTrial, Terms, quantities_of
from tsas_cli.drive.runs import DriveRun, frequency_response
from tsas_cli.numerics.covariance import block_length, block_numbers
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

GEAR = ("ripple", "play")
EFFECT_OF = {
    "spring": "drive_compliance",
    "lag": "channel_delay",
    "delay": "channel_delay",
    "ripple": "drive_ripple",
    "play": "backlash",
}
MOST_BLOCKS = 200  # more would hold too little of the motion each
COVERED = 0.7  # of a run's highest frequency, that another run has to show to predict it
ROUNDS = 3
NOTHING: Terms = frozenset()


@dataclass(eq=False)
class DriveSearch:
    """The sets of terms fitted to one dataset so far, each once, compared on held-out data.

    A fit begins with those of the simpler sets that are there when it is first asked for. `squares`
    caches the held-out ones by set, block by block of the folds.
    """

    bench: DriveBench
    step: Steps = NO_PROGRESS
    trials: dict[Terms, DriveTrial] = field(default_factory=dict)
    ahead: set[Terms] = field(default_factory=set)  # sets of terms that are known to be fitted
    squares: dict[Terms, Floats] = field(default_factory=dict)
    folds: Folds = field(init=False)

    def trial(self, terms: Terms) -> DriveTrial:
        """Return the fit of a set of terms, no worse than that of any simpler one known."""
        if terms not in self.trials:
            self._expect([terms])
            known = (self.trials.get(terms - {t}) for t in sorted(terms))
            simpler = [trial for trial in known if trial is not None]
            self.trials[terms] = self.bench.fit(terms, simpler)
            self.step()
        return self.trials[terms]

    def trials_of(self, sets: Sequence[Terms]) -> list[DriveTrial]:
        """Return the fits of sets of terms; those that are not known yet lie ahead."""
        self._expect(sets)
        return [self.trial(terms) for terms in sets]

    def _expect(self, sets: Iterable[Terms]) -> None:
        """Say which fits lie ahead, each once."""
        new = set(sets) - self.ahead
        self.step.ahead(len(new))
        self.ahead |= new

    def fold(self, best: DriveTrial) -> None:
        """Hold out in blocks that outlast the memory of what a fit leaves, from now on."""
        runs = self.bench.runs
        ends = np.cumsum([int(run.counts.sum()) for run in runs])[:-1]
        self.folds = drive_folds(runs, np.split(best.solution.residual, ends))
        self.squares.clear()

    def held_out(self, terms: Terms) -> Floats:
        """Return the held-out squares of a set of terms, block by block."""
        if terms not in self.squares:
            self.squares[terms] = held_out_squares(self.trial(terms), self.folds)
        return self.squares[terms]

    def gain(self, before: Terms, after: Terms) -> Reduction:
        """Compare two sets of terms."""
        return gain(self.held_out(before), self.held_out(after))

    def mean_square(self, terms: Terms) -> float:
        """Return the held-out mean square, 1 where nothing but noise is left."""
        return float(self.held_out(terms).sum()) / self.folds.block.size


def find_terms(search: DriveSearch) -> Terms:
    """Return the terms that the recordings show; the folds stay those that they were chosen by."""
    search.fold(min(search.trials_of(structures()), key=lambda t: t.mean_square))
    named = chosen(search, NOTHING)
    for _ in range(ROUNDS):
        more = _with_gear(search, named)
        if more == named:
            break
        search.fold(search.trial(more))  # what is left has a shorter memory: more blocks speak
        named = _without_idle_gear(search, chosen(search, more & frozenset(GEAR)))
    return named


def structures(gear: Terms = NOTHING) -> list[Terms]:
    """Return all structures of G(s), the simplest first, with what is in the gear."""
    linear = [frozenset(c) for n in range(len(LINEAR) + 1) for c in combinations(LINEAR, n)]
    return sorted((c | gear for c in linear), key=lambda c: len(quantities_of(c)))


def chosen(search: DriveSearch, gear: Terms) -> Terms:
    """Return the simplest structure that the best one does not surely beat."""
    every = structures(gear)
    search.trials_of(every)
    ended = [t for t in every if search.trial(t).solution.converged] or every
    best = min(ended, key=lambda t: float(search.held_out(t).sum()))
    return next(
        t
        for t in ended
        if t == best or not search.gain(t, best).beyond(LEAST_REDUCTION_PER_COMPLEXITY)
    )


def rivals(search: DriveSearch, named: Terms, term: str) -> tuple[str, ...]:
    """Return the terms that would do as well in place of a named one."""
    fewer = named - {term}
    out = []
    for other in EFFECT_OF:
        if other in named:
            continue
        instead = fewer | {other}
        helps = search.gain(fewer, instead).convincing
        if helps and not search.gain(instead, named).beyond(LEAST_DIFFERENCE):
            out.append(other)
    return tuple(out)


def _with_gear(search: DriveSearch, named: Terms) -> Terms:
    """Add what convinces in the gear, alone or together, where there is something left."""
    left = [g for g in GEAR if g not in named]
    if not left or search.mean_square(named) < 1.0 + EXCESS_OF_COMPLETE_MODEL:
        return named
    sets = [frozenset({g}) for g in left] + ([frozenset(left)] if len(left) > 1 else [])
    search.trials_of([named | s for s in sets])
    found = [(s, search.gain(named, named | s)) for s in sets]
    good = [(s, g) for s, g in found if g.convincing]
    if not good:
        return named
    best = max(good, key=lambda f: f[1].part)[0]
    for s, _ in good:  # a single one that both together do not surely beat
        if not search.gain(named | s, named | best).beyond(LEAST_REDUCTION_PER_COMPLEXITY):
            return named | s
    return named | best


def _without_idle_gear(search: DriveSearch, named: Terms) -> Terms:
    for g in sorted(named & frozenset(GEAR)):
        if not search.gain(named - {g}, named).convincing:
            return chosen(search, named & frozenset(GEAR) - {g})
    return named


def drive_folds(runs: Sequence[DriveRun], residuals: Sequence[Floats]) -> Folds:
    """Return what is held out together, in blocks longer than the memory of these residuals.

    Runs are held out where each shows frequencies that another one shows too; else stretches of
    each run, in turns: what only one run excites no other can predict.
    """
    samples = sum(r.size for r in residuals)
    length = max(block_length(list(residuals)), samples // MOST_BLOCKS)
    sizes = [r.size for r in residuals]
    block = block_numbers(sizes, length)
    run = np.repeat(np.arange(len(runs)), sizes)
    if _covered(runs):
        return Folds(run, block, run, by_run=True)
    return Folds(block % STRETCHES, block, run, by_run=False)


def _covered(runs: Sequence[DriveRun]) -> bool:
    """Say whether each run's band is seen by another one as well."""
    if len(runs) < 2:
        return False
    bands = [frequency_response([run]).band for run in runs]
    highest = sorted(0.0 if band is None else band[1] for band in bands)
    return highest[-1] > 0.0 and highest[-2] >= COVERED * highest[-1]
