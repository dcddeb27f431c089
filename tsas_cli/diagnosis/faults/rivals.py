"""Whether one effect of the catalogue explains as much as a fault of the recordings does.

An effect acts in all runs by one law: where it leaves as little as a fault of one run, it is the
simpler explanation, and the search for causes goes on.
"""

from collections.abc import Iterator

from tsas_cli.diagnosis.faults.beside import beside
from tsas_cli.diagnosis.faults.candidates import OWN_FRICTION
from tsas_cli.diagnosis.faults.search import FoundFault
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.hypotheses import Names
from tsas_cli.diagnosis.search import EXCESS_OF_COMPLETE_MODEL, LINEAR

AS_GOOD = 0.1  # of the usual squares, that an effect may leave more than the fault


def effects_as_good(fits: Fits, fault: FoundFault) -> Iterator[str]:
    """Yield the effects of the catalogue that explain as much as a fault, each fitted by itself."""
    nominal = fits.trial(frozenset())
    squares = float(nominal.solution.residual @ nominal.solution.residual)
    beyond = max(fault.rest - fault.usual, 0.0)  # the noise: an effect may leave twice as much
    least = LINEAR * fault.share * fault.excess / squares
    for screened in fits.screen(frozenset()):
        if screened.part < least:
            return
        name = screened.effect.name
        if _left_by(fits, frozenset({name}), fault) < fault.rest + beyond + AS_GOOD * fault.usual:
            yield name


def leaves_noise(fits: Fits, names: Names, fault: FoundFault) -> bool:
    """Return whether a set of effects leaves no more than a complete model may."""
    most = (1.0 + EXCESS_OF_COMPLETE_MODEL) * fault.usual
    return _left_by(fits, names, fault) < most


def _left_by(fits: Fits, names: Names, fault: FoundFault) -> float:
    """Return the squares that a set of effects leaves, beside what the fault was sought beside."""
    tolerated = fits.tolerated[fits.trial(frozenset()).on_mesh]
    alike = fault.found[0].code == OWN_FRICTION
    return beside(fits.trial(names), tolerated, fits.folds.run, alike=alike).squares
