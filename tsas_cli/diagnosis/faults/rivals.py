"""Whether one effect of the catalogue explains as much as a fault of the recordings does.

An effect acts in all runs by one law: where it leaves as little as a fault of one run, it is the
simpler explanation, and the search for causes goes on.
"""

from collections.abc import Iterator

from tsas_cli.diagnosis.faults.beside import beside
from tsas_cli.diagnosis.faults.candidates import OWN_FRICTION
from tsas_cli.diagnosis.faults.search import FoundFault
from tsas_cli.diagnosis.hypotheses import Names
from tsas_cli.diagnosis.search import EXCESS_OF_COMPLETE_MODEL, LINEAR, Search

AS_GOOD = 0.1  # of the noise's squares, that an effect may leave more than the fault


def effects_as_good(search: Search, fault: FoundFault) -> Iterator[str]:
    """Yield the effects of the catalogue that explain as much as a fault, each fitted by itself."""
    nominal, count = search.trial(frozenset()), search.folds.run.size
    squares = float(nominal.solution.residual @ nominal.solution.residual)
    beyond = max(fault.rest - count, 0.0)  # the noise: an effect may leave twice as much
    least = LINEAR * fault.share * fault.excess / squares
    for screened in search.screen(frozenset()):
        if screened.part < least:
            return
        name = screened.effect.name
        if _left_by(search, frozenset({name}), fault) < fault.rest + beyond + AS_GOOD * count:
            yield name


def leaves_noise(search: Search, names: Names, fault: FoundFault) -> bool:
    """Return whether a set of effects leaves no more than a complete model may."""
    most = (1.0 + EXCESS_OF_COMPLETE_MODEL) * search.folds.run.size
    return _left_by(search, names, fault) < most


def _left_by(search: Search, names: Names, fault: FoundFault) -> float:
    """Return the squares that a set of effects leaves, beside what the fault was sought beside."""
    tolerated = search.tolerated[search.trial(frozenset()).on_mesh]
    alike = fault.found[0].code == OWN_FRICTION
    return beside(search.trial(names), tolerated, search.folds.run, alike=alike).squares
