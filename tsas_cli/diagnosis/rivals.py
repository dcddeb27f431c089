"""The effects that a search finds, exchanged for better or simpler ones, with their rivals."""

from dataclasses import replace

from tsas_cli.diagnosis.evidence import LEAST_DIFFERENCE, LEAST_REDUCTION_PER_COMPLEXITY
from tsas_cli.diagnosis.hypotheses import Hypotheses, Names, judged_sets
from tsas_cli.diagnosis.search import Search, tried
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.quantities import QUANTITIES

MODEL_ERROR = 0.1  # of the squares that a wrong model leaves, by which two effects differ by chance
ONE_CHANNEL = 0.1  # of an effect's reduction: what forms of laws differ by, where one channel tells
SIMPLER = LEAST_REDUCTION_PER_COMPLEXITY - LEAST_DIFFERENCE  # that a simpler effect leaves more


def find_effects(search: Search) -> Hypotheses:
    """Return the effects that are significant together, their rivals, and all other fits."""
    named = exchanged(search, search.run())
    unsure = MODEL_ERROR * search.structure(named)
    of_forms = ONE_CHANNEL if len(search.bench.channels) == 1 else 0.0
    rivals = {
        e.name: rivals_of(search, named, e.name, unsure, of_forms)
        for e in EFFECTS
        if e.name in named
    }
    screened = tuple(search.screen(frozenset()))
    for names in judged_sets(named):
        search.trial(names, on_mesh=search.bench.on_mesh(named))
    return replace(tried(search), named=named, rivals=rivals, screened=screened)


def exchanged(search: Search, named: Names, before: frozenset[Names] = frozenset()) -> Names:
    """Return the set with effects exchanged for rivals that are better, or simpler.

    Beside those that were found later, another effect may be the better one; of two that do as
    well, the one with fewer parameters is. `before` are the sets on the path.
    """
    for name in sorted(named):
        for other in rivals_of(search, named, name, SIMPLER):
            instead = named - {name} | {other}
            better = search.gain(named, instead).beyond(LEAST_DIFFERENCE)
            simpler = _parameters(search, instead, other) < _parameters(search, named, name)
            if (better or simpler) and instead not in before:
                return exchanged(search, instead, before | {named})
    return named


def rivals_of(
    search: Search, named: Names, name: str, unsure: float = 0.0, of_forms: float = 0.0
) -> tuple[str, ...]:
    """Return the effects that do as well as a named one in its place, or better.

    Those that leave more by a share that is `unsure` do as well too; so do those whose reduction is
    smaller by less than the share `of_forms`.
    """
    fewer = named - {name}
    alike = (1.0 - of_forms) * search.gain(fewer, named).part
    out = []
    for other, found in search.add(fewer, search.reduction(fewer, named)):
        instead = fewer | {other}
        if other in named or not found.convincing:
            continue
        if not search.trial(instead).solution.converged:
            continue
        worse = search.gain(instead, named).beyond(LEAST_DIFFERENCE + unsure)
        if not worse or (of_forms > 0.0 and search.gain(fewer, instead).part > alike):
            out.append(other)
    return tuple(out)


def _parameters(search: Search, names: Names, name: str) -> int:
    """Return the number of an effect's parameters in a fit, without sizes that are at a bound."""
    trial = search.trial(names)
    own = (
        (QUANTITIES[u.name], at_bound)
        for u, at_bound in zip(trial.unknowns, trial.solution.at_bound, strict=True)
        if u.name.split(".")[0] == name
    )
    return sum(bool(quantity.shape or not at_bound) for quantity, at_bound in own)
