"""The effects that a search finds, exchanged for better or simpler ones, with their rivals."""

from collections.abc import Iterator
from dataclasses import replace

from tsas_cli.diagnosis.evidence import LEAST_DIFFERENCE, LEAST_REDUCTION_PER_COMPLEXITY
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.hypotheses import Hypotheses, Names, judged_sets
from tsas_cli.diagnosis.remainder import MOST_SLOW
from tsas_cli.diagnosis.search import add, is_by_tolerances, significant_effects
from tsas_cli.effects import EFFECTS
from tsas_cli.effects.load_friction import LOAD_FRICTION
from tsas_cli.effects.load_hysteresis import LOAD_HYSTERESIS
from tsas_cli.identification.quantities import QUANTITIES

MODEL_ERROR = 0.1  # of the squares that a wrong model leaves, by which two effects differ by chance
ONE_CHANNEL = 0.1  # of an effect's reduction: what forms of laws differ by, where one channel tells
PRESLIDING = 0.01  # of the stroke: a hysteresis that yields within it is friction that slides late
CLEARLY = 0.5  # times the squares: of two effects, one that leaves so much fits clearly better
SIMPLER = LEAST_REDUCTION_PER_COMPLEXITY - LEAST_DIFFERENCE  # that a simpler effect leaves more

FRICTION, HYSTERESIS = LOAD_FRICTION.name, LOAD_HYSTERESIS.name


def find_effects(fits: Fits) -> Hypotheses:
    """Return the effects that are significant together, their rivals, and all other fits."""
    named = exchanged(fits, significant_effects(fits))
    unsure = MODEL_ERROR * fits.structure(named)
    of_forms = ONE_CHANNEL if len(fits.bench.channels) == 1 else 0.0
    rivals = {
        e.name: rivals_of(fits, named, e.name, unsure, of_forms) for e in EFFECTS if e.name in named
    }
    if is_presliding(fits, named):
        rivals[HYSTERESIS] = tuple(dict.fromkeys((*rivals[HYSTERESIS], FRICTION)))
    screened = tuple(fits.screen(frozenset()))
    for names in judged_sets(named):
        fits.trial(names, on_mesh=fits.bench.on_mesh(named))
    return replace(fits.so_far(), named=named, rivals=rivals, screened=screened)


def exchanged(fits: Fits, named: Names, before: frozenset[Names] = frozenset()) -> Names:
    """Return the set with effects exchanged for rivals that are better, or simpler.

    Beside those that were found later, another effect may be the better one; of two that do as
    well, the one with fewer parameters is. `before` are the sets on the path.
    """
    for name in sorted(named):
        for other in rivals_of(fits, named, name, SIMPLER):
            instead = named - {name} | {other}
            better = fits.gain(named, instead).beyond(LEAST_DIFFERENCE)
            simpler = _parameters(fits, instead, other) < _parameters(fits, named, name)
            if (better or simpler) and instead not in before:
                return exchanged(fits, instead, before | {named})
    return named


def rivals_of(
    fits: Fits, named: Names, name: str, unsure: float = 0.0, of_forms: float = 0.0
) -> tuple[str, ...]:
    """Return the effects that do as well as a named one in its place, or better.

    Those that leave more by a share that is `unsure` do as well too; so do those whose reduction is
    smaller by less than the share `of_forms`. One that fits all the data no worse, by more
    parameters, may predict worse by what these cost. So may one that fits clearly better, where
    most of what the named ones leave is taken for tolerances.
    """
    fewer = named - {name}
    by_tolerances = is_by_tolerances(fits, named)
    alike = (1.0 - of_forms) * fits.gain(fewer, named).part
    out = []
    for other, found in add(fits, fewer, fits.reduction(fewer, named)):
        instead = fewer | {other}
        if other in named or not found.convincing:
            continue
        trial = fits.trial(instead)
        if not trial.solution.converged:
            continue
        squares = trial.mean_square / fits.trial(named).mean_square
        costs = LEAST_DIFFERENCE if squares > 1.0 else LEAST_REDUCTION_PER_COMPLEXITY
        as_good = not fits.gain(instead, named).beyond(costs + unsure)
        as_form = of_forms > 0.0 and fits.gain(fewer, instead).part > alike
        if as_good or as_form or (by_tolerances and squares < CLEARLY):
            out.append(other)
    return tuple(out)


def rivals_within(found: Hypotheses, named: Names, name: str) -> tuple[str, ...]:
    """Return the effects that do as well as one of a set, of the fits that a search has made.

    For a set that is left when others are not proven: what does as well beside those is known.
    """
    out = []
    for other, mesh, squares in _in_its_place(found, named, name):
        if (named, mesh) not in found.squares:
            continue
        least = float(found.squares[named, mesh].sum())
        structure = max(1.0 - found.folds.block.size / least, 0.0)
        if squares <= (1.0 + MODEL_ERROR * structure) * least:
            out.append(other)
    return tuple(dict.fromkeys(out))


def leaving_noise(found: Hypotheses, named: Names, name: str) -> tuple[str, ...]:
    """Return the effects that leave noise alone in the place of one of a set, the best first.

    Of the fits that a search has made, for one that is not proven: that others leave more than it
    does is then nothing against them.
    """
    left = {
        other: squares
        for other, _, squares in _in_its_place(found, named, name)
        if squares < (1.0 + MOST_SLOW) * found.folds.block.size
    }
    return tuple(sorted(left, key=left.__getitem__))


def _in_its_place(found: Hypotheses, named: Names, name: str) -> Iterator[tuple[str, bool, float]]:
    """Yield each effect that a search has fitted in the place of one of a set.

    With whether on the mesh, and the held-out squares that are left; a fit has to have converged.
    """
    for (others, mesh), squares in found.squares.items():
        instead = others - named
        in_place = len(instead) == 1 and others == named - {name} | instead
        if in_place and found.trials[others, mesh].solution.converged:
            yield next(iter(instead)), mesh, float(squares.sum())


def is_presliding(fits: Fits, named: Names) -> bool:
    """Return whether a named hysteresis of the load may be friction of its guide.

    Dry friction gives way elastically before it slides, by micrometres, which its law leaves out.
    """
    if HYSTERESIS not in named or FRICTION in named:
        return False
    travel_mm = fits.trial(named).values()[f"{HYSTERESIS}.travel_mm"]
    return travel_mm < PRESLIDING * fits.bench.longest_stroke_mm


def _parameters(fits: Fits, names: Names, name: str) -> int:
    """Return the number of an effect's parameters in a fit, without sizes that are at a bound."""
    trial = fits.trial(names)
    own = (
        (QUANTITIES[u.name], at_bound)
        for u, at_bound in zip(trial.unknowns, trial.solution.at_bound, strict=True)
        if u.name.split(".")[0] == name
    )
    return sum(bool(quantity.shape or not at_bound) for quantity, at_bound in own)
