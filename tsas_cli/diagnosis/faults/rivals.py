"""Whether one effect of the catalogue explains as much as a fault of the recordings does.

An effect acts in all runs by one law: where it leaves as little as a fault of one run, it is the
simpler explanation, and the search for causes goes on.
"""

from collections.abc import Iterator

from tsas_cli.diagnosis.faults.candidates import OWN_FRICTION, beside
from tsas_cli.diagnosis.faults.search import FoundFault
from tsas_cli.diagnosis.search import LINEAR, Search

AS_GOOD = 0.1  # of the noise's squares, that an effect may leave more than the fault


def effects_as_good(search: Search, fault: FoundFault) -> Iterator[str]:
    """Yield the effects of the catalogue that explain as much as a fault, each fitted by itself."""
    folds = search.folds
    nominal = search.trial(frozenset())
    tolerated = search.tolerated[nominal.on_mesh]
    squares = float(nominal.solution.residual @ nominal.solution.residual)
    alike = fault.found[0].code == OWN_FRICTION
    beyond = max(fault.rest - folds.run.size, 0.0)  # the noise: an effect may leave twice as much
    least = LINEAR * fault.share * fault.excess / squares
    for screened in search.screen(frozenset()):
        if screened.part < least:
            return
        trial = search.trial(frozenset({screened.effect.name}))
        if (
            beside(trial, tolerated, folds.run, alike=alike).squares
            < fault.rest + beyond + AS_GOOD * folds.run.size
        ):
            yield screened.effect.name
