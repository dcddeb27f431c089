"""Which lags and which hidden effects a drive has: full fits of all, judged on held-out data.

All sixteen structures of G(s) are fitted; the simplest one is taken that the best does not surely
beat. Where it leaves more than noise, ripple and play are tried on top, and with what convinces
the structure is chosen again, since lags imitate play and the other way round.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.evidence import APART, RICHER, Gain, gain
from tsas_cli.diagnosis.held_out import STRETCHES, Folds, held_out_squares
from tsas_cli.diagnosis.search import BLURRED
from tsas_cli.identification.drive_fit import LINEAR, DriveBench, DriveTrial, Terms, quantities_of
from tsas_cli.identification.drive_runs import DriveRun
from tsas_cli.identification.frequency_response import frequency_response
from tsas_cli.numerics.covariance import block_length, block_numbers
from tsas_cli.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]

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


@dataclass
class DriveSearch:
    """The sets of terms that were fitted to one dataset, with their held-out squares."""

    bench: DriveBench
    step: Steps = SILENT
    trials: dict[Terms, DriveTrial] = field(default_factory=dict)
    squares: dict[Terms, Floats] = field(default_factory=dict)
    ahead: set[Terms] = field(default_factory=set)  # sets of terms that are known to be fitted

    @cached_property
    def folds(self) -> Folds:
        """What is held out together; the blocks outlast the memory of what the best one leaves."""
        best = min(self.trials_of(self.structures()), key=lambda t: t.mean_square)
        return self._folds_by(best)

    def _folds_by(self, best: DriveTrial) -> Folds:
        sizes = [int(run.counts.sum()) for run in self.bench.runs]
        residuals = np.split(best.solution.residual, np.cumsum(sizes)[:-1])
        return drive_folds(self.bench.runs, residuals)

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

    def held_out(self, terms: Terms) -> Floats:
        """Return the held-out squares of a set of terms, block by block."""
        if terms not in self.squares:
            self.squares[terms] = held_out_squares(self.trial(terms), self.folds)
        return self.squares[terms]

    def gain(self, before: Terms, after: Terms) -> Gain:
        """Compare two sets of terms."""
        return gain(self.held_out(before), self.held_out(after))

    def mean_square(self, terms: Terms) -> float:
        """Return the held-out mean square, 1 where nothing but noise is left."""
        return float(self.held_out(terms).sum()) / self.folds.block.size

    def structures(self, gear: Terms = NOTHING) -> list[Terms]:
        """Return all structures of G(s), the simplest first, with what is in the gear."""
        chosen = [frozenset(c) for n in range(len(LINEAR) + 1) for c in combinations(LINEAR, n)]
        return sorted((c | gear for c in chosen), key=lambda c: len(quantities_of(c)))

    def chosen(self, gear: Terms) -> Terms:
        """Return the simplest structure that the best one does not surely beat."""
        structures = self.structures(gear)
        self.trials_of(structures)
        told = [t for t in structures if self.trial(t).solution.converged] or structures
        best = min(told, key=lambda t: float(self.held_out(t).sum()))
        return next(t for t in told if t == best or not self.gain(t, best).beyond(RICHER))

    def run(self) -> Terms:
        """Return the terms that the recordings show."""
        named = self.chosen(NOTHING)
        for _ in range(ROUNDS):
            more = self._more(named)
            if more == named:
                return named
            # What is left now has a shorter memory: more blocks speak.
            self.folds, self.squares = self._folds_by(self.trial(more)), {}
            named = self._without_idle_gear(self.chosen(more & frozenset(GEAR)))
        return named

    def rivals(self, named: Terms, term: str) -> tuple[str, ...]:
        """Return the terms that would do as well in place of a named one."""
        fewer = named - {term}
        out = []
        for other in EFFECT_OF:
            if other in named:
                continue
            instead = fewer | {other}
            helps = self.gain(fewer, instead).convincing
            if helps and not self.gain(instead, named).beyond(APART):
                out.append(other)
        return tuple(out)

    def _more(self, named: Terms) -> Terms:
        """Add what convinces in the gear, alone or together, where there is something left."""
        left = [g for g in GEAR if g not in named]
        if not left or self.mean_square(named) < 1.0 + BLURRED:
            return named
        sets = [frozenset({g}) for g in left] + ([frozenset(left)] if len(left) > 1 else [])
        self.trials_of([named | s for s in sets])
        found = [(s, self.gain(named, named | s)) for s in sets]
        good = [(s, g) for s, g in found if g.convincing]
        if not good:
            return named
        best = max(good, key=lambda f: f[1].part)[0]
        for s, _ in good:  # a single one that both together do not surely beat
            if not self.gain(named | s, named | best).beyond(RICHER):
                return named | s
        return named | best

    def _without_idle_gear(self, named: Terms) -> Terms:
        for g in sorted(named & frozenset(GEAR)):
            if not self.gain(named - {g}, named).convincing:
                return self.chosen(named & frozenset(GEAR) - {g})
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
