"""Elastic travel of a few micrometres: no cause, and part of every model where the data show it.

The search may find it; it is then no more than a tolerance. The tests of causes and the models that
are written fit it with the rest: on a stiff tendon three micrometres are more newtons than the
noise, and a model without them predicts other runs worse.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from tsas_cli.diagnosis.friction_scatter import PLAUSIBLE
from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.diagnosis.tolerances import PRESLIDING, TRAVEL, TRAVEL_MM
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import unknown_of
from tsas_cli.identification.quantities import QUANTITIES

SIGNIFICANT = 4.0  # standard errors of the travel


def with_tolerated_travel(search: Hypotheses) -> Hypotheses:
    """Return a search whose bench frees the travel beside its named effects, if it is significant.

    Unchanged where a cause has a travel of its own, or more than the plausible travel fits best.
    """
    bench, effects = search.bench, sorted(search.named)
    if PRESLIDING in effects:
        return search
    scaled = QUANTITIES[TRAVEL].scaled
    travel = replace(unknown_of(TRAVEL, scaled(TRAVEL_MM)), upper=scaled(PLAUSIBLE * TRAVEL_MM))
    freed = replace(bench, free=(*bench.free, travel), never_closed=True)
    trial = freed.fit(effects, near=search.nearest(search.named))
    counted = search.folds.blocks_of_runs(len(bench.rigs))
    found = with_errors(trial.unknowns, trial.solution, counted, by_run=True)
    at = [u.name for u in trial.unknowns].index(TRAVEL)
    if found.at_bound[at] or not found.values[at] > SIGNIFICANT * found.stderr[at]:
        return search
    return replace(search, bench=freed, trials={(search.named, True): trial}, squares={})


def travel_notes(estimates: Iterable[Estimate], named: Iterable[str]) -> Iterator[str]:
    """Yield that the model has a travel that is no cause."""
    if PRESLIDING in named:
        return
    for estimate in estimates:
        if estimate.name == TRAVEL:
            yield (
                f"The model has {1e3 * estimate.value:.2g} µm of elastic travel before sliding "
                f"({TRAVEL}), as every tendon may: that is no cause."
            )
