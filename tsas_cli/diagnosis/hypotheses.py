"""The fits that a search has made, and the named effects fitted again with new weights."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from tsas_cli.diagnosis.evidence import (
    Reduction,
    gain,
)
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.identification.extension import Bench, reweighted_bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.screening import Screened
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

Names = frozenset[str]
REWEIGHTINGS = 3  # iterations of new weights and a new fit of the named effects


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """Result of a search: the named effects, their rivals, and all fits.

    `trials` and `squares` have each fitted set of effects, off and on the mesh, with its held-out
    squares by block, `screened` all effects screened with none named.
    """

    bench: Bench
    folds: Folds
    named: Names
    rivals: Mapping[str, tuple[str, ...]]
    screened: tuple[Screened, ...]
    trials: Mapping[tuple[Names, bool], HypothesisFit]
    squares: Mapping[tuple[Names, bool], Floats]

    def trial(self, names: Names, *, on_mesh: bool = False) -> HypothesisFit:
        """Return the fit of a set of effects, that on the mesh if any of it needs one."""
        return self.trials[names, on_mesh or self.bench.on_mesh(names)]

    def nearest(self, names: Names) -> HypothesisFit:
        """Return the fit of a set of effects, or of the set that differs from it least."""
        mesh = self.bench.on_mesh(names)
        return self.trials[min(self.trials, key=lambda key: (len(key[0] ^ names), key[1] != mesh))]

    def held_out(self, names: Names, *, on_mesh: bool = False) -> Floats:
        """Return the held-out squares of a set of effects, block by block."""
        return self.squares[names, on_mesh or self.bench.on_mesh(names)]

    def gain(self, names: Names) -> Reduction:
        """Return the reduction by a set of effects, both fits on the mesh if it needs one."""
        mesh = self.bench.on_mesh(names)
        return gain(self.held_out(frozenset(), on_mesh=mesh), self.held_out(names))

    def best_alone(self, without: Names) -> tuple[str, Reduction] | None:
        """Return the effect that gains most alone, but for some; None where none was fitted."""
        found = [
            (name, gain(self.squares[frozenset(), mesh], squares))
            for (names, mesh), squares in self.squares.items()
            if len(names) == 1 and not names & without and (frozenset(), mesh) in self.squares
            for name in names
        ]
        return max(found, key=lambda pair: pair[1].part, default=None)


def reweighted_hypotheses(found: Hypotheses, step: Steps = NO_PROGRESS) -> Hypotheses:
    """Return the fits of the named effects, of none, and of all but one, with new weights.

    The weights are those at the named effects' fit. Rivals and signatures are unchanged; there are
    no squares.
    """
    named, bench = found.named, found.bench
    mesh = bench.on_mesh(named)
    trial = found.nearest(named)
    sets = judged_sets(named)
    step.doing(f"tests {', '.join(sorted(named)) or 'the nominal model'}")
    step.ahead(REWEIGHTINGS + len(sets))
    for _ in range(REWEIGHTINGS):
        bench = reweighted_bench(bench, trial)
        trial = bench.fit(sorted(named), near=trial, on_mesh=mesh, values_only=True)
        step()
    trials = {}
    known = {**found.trials, (named, mesh): trial}
    for names in sets:
        near = known.get((names, mesh), trial)
        trials[names, mesh] = bench.fit(sorted(names), near=near, on_mesh=mesh)
        step()
    return replace(found, bench=bench, trials=trials, squares={})


def judged_sets(named: Names) -> set[Names]:
    """Return the named set, the empty one, and those with one effect removed."""
    return {frozenset[str](), named, *(named - {name} for name in named)}
