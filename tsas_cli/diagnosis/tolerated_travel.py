"""Elastic travel of a few micrometres: no cause, and part of every model where the data show it.

The search may find it; it is then no more than a tolerance. The tests of causes and the models that
are written fit it with the rest: on a stiff tendon three micrometres are more newtons than the
noise, and a model without them predicts other runs worse.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.diagnosis.refitted import raw_gain, raw_squares
from tsas_cli.diagnosis.tolerances import GROWTH, LONGEST_MM, PRESLIDING, TRAVEL, TRAVEL_MM
from tsas_cli.effects.presliding import AT_N, Presliding, travel_at
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES

SIGNIFICANT = 4.0  # standard errors of the travel


def is_tolerated(bench: Bench, trial: HypothesisFit) -> bool:
    """Return whether a trial's travel is no longer than a plausible one at the preload.

    It is not linear in what it changes, so that its length is compared.
    """
    values = trial.values()
    travel_mm = travel_at(_mean_preload(bench), Presliding(values[TRAVEL], values[GROWTH]))
    return travel_mm <= LONGEST_MM


def with_tolerated_travel(search: Hypotheses) -> Hypotheses:
    """Return a search whose bench frees the travel beside its named effects, if it is significant.

    Or if it lowers the raw squares, since what lags at each reversal has next to no weight.
    Unchanged where a cause has a travel of its own, or more than the plausible travel fits best.
    """
    bench, effects = search.bench, sorted(search.named)
    if PRESLIDING in effects:
        return search
    longest_mm = LONGEST_MM * max(1.0, AT_N / _mean_preload(bench))
    scaled = QUANTITIES[TRAVEL].scaled
    travel = replace(unknown_of(TRAVEL, scaled(TRAVEL_MM)), upper=scaled(longest_mm))
    free = (*bench.free, travel, unknown_of(GROWTH))
    freed = replace(bench, free=free, never_closed=True)
    trial = freed.fit(effects, near=search.nearest(search.named))
    counted = search.folds.blocks_of_runs(len(bench.rigs))
    held = trial.holding([GROWTH])  # without a travel its growth has no meaning (Davies 1977)
    found = with_errors(held.unknowns, held.solution, counted, by_run=True)
    at = [u.name for u in held.unknowns].index(TRAVEL)
    if found.at_bound[at] or not is_tolerated(bench, trial):
        return search
    if found.values[at] < SIGNIFICANT * found.stderr[at]:
        plain = search.trials.get((search.named, bench.on_mesh(effects)))
        if plain is None:  # what is left of a set that fails need not have been fitted
            plain = bench.fit(effects, near=search.nearest(search.named))
        without, beside = (
            raw_squares(of, fit, search.folds) for of, fit in ((bench, plain), (freed, trial))
        )
        if not raw_gain(without, beside).convincing:
            return search
    return replace(search, bench=freed, trials={(search.named, True): trial}, squares={})


def _mean_preload(bench: Bench) -> float:
    """Return the mean preload of the runs, at least a newton [N]."""
    return max(float(np.mean([rig.preload_N for rig in bench.rigs])), 1.0)


def travel_notes(estimates: Iterable[Estimate], named: Iterable[str]) -> Iterator[str]:
    """Yield that the model has a travel that is no cause."""
    if PRESLIDING in named:
        return
    for estimate in estimates:
        if estimate.name == TRAVEL:
            yield (
                f"The model has {1e3 * estimate.value:.2g} µm of elastic travel before sliding at "
                f"{AT_N:.0f} N ({TRAVEL}), as every tendon may: that is no cause."
            )
