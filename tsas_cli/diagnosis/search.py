"""Find the smallest set of effects that no other set improves on held-out runs.

Stepwise selection: one effect after the other is added while the best one is significant; after
each, earlier ones that have become redundant are removed. Where no single effect is significant,
pairs are screened together, because effects of opposite sign mask each other. Where the nominal
model leaves noise alone, a first effect has to take more of it, or be more significant; where it
leaves less than is known of the noise, be more significant. Where noise alone is left since most
is taken for tolerances, a further effect has to as well.
"""

from collections.abc import Callable
from itertools import combinations
from operator import attrgetter

from tsas_cli.diagnosis.evidence import (
    LEAST_REDUCTION,
    LEAST_REDUCTION_PER_COMPLEXITY,
    REPEATS,
    Reduction,
)
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.hypotheses import Names
from tsas_cli.diagnosis.remainder import MOST_SLOW, remainder_of
from tsas_cli.effects import Effect
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.screening import least_part, parts_of_pairs

MOST_EFFECTS = 4
SHARE = 0.2  # least reduction of the excess over the noise by a cause
LEAST = 0.003  # least reduction of the nominal model's excess by a further cause,
MOST = 0.5  # unless it takes that share of what is left
EXCESS_OF_COMPLETE_MODEL = 0.15  # excess of the mean square that a complete model may have
MOST_OF_TOLERANCES = 0.5  # share of the squares beyond which a cause is sought in their place
LINEAR = 0.4  # share of its reduction that a signature explains; a fit takes up to 2.5 times it
Criterion = Callable[[Reduction], bool]
PAIRS = 4  # of effects that are fitted, of those that explain most together


def significant_effects(fits: Fits) -> Names:
    """Return the effects that are significant together."""
    return _grown(fits, frozenset(), frozenset())


def _grown(fits: Fits, named: Names, before: frozenset[Names]) -> Names:
    """Return the named effects, extended while an effect is significant.

    `before` are the sets on the path. Where a simpler effect is not significantly worse than
    the best one, both branches are searched to their ends: the residual of the simpler effect
    may be one that no further effect explains.
    """
    if len(named) >= MOST_EFFECTS or named in before:
        return named
    if named and not is_by_tolerances(fits, named) and is_quiet(fits, named):
        return named
    ends = [
        _grown(fits, _without_redundant(fits, better), before | {named})
        for better in _better(fits, named)
    ]
    if not ends:
        return named
    simple, best = ends[0], ends[-1]
    return best if fits.gain(simple, best).beyond(LEAST_REDUCTION_PER_COMPLEXITY) else simple


def held_out_mean_square(fits: Fits, names: Names) -> float:
    """Return the mean square of the residuals with these effects on held-out data."""
    squares = fits.held_out(names, scatter=fits.scatters(names, fits.bench.on_mesh(names)))
    return float(squares.sum()) / fits.folds.block.size


def is_quiet(fits: Fits, names: Names) -> bool:
    """Return whether noise alone, white or slow, is left with these effects."""
    mean_square = held_out_mean_square(fits, names)
    if mean_square < 1.0 + EXCESS_OF_COMPLETE_MODEL:
        return True
    return mean_square < 1.0 + MOST_SLOW and is_complete(fits, names)


def is_by_tolerances(fits: Fits, names: Names) -> bool:
    """Return whether what little these effects leave is so because most is taken for tolerances."""
    return fits.of_tolerances(names) > MOST_OF_TOLERANCES


def is_complete(fits: Fits, names: Names) -> bool:
    """Return whether a regression finds nothing that a further cause could explain."""
    if names not in fits.complete:
        fits.complete[names] = remainder_of(fits.bench, fits.trial(names), fits.folds).complete
    return fits.complete[names]


def matters(fits: Fits, before: Names, added: Names) -> bool:
    """Return whether added effects reduce the excess over the noise by a sufficient share."""
    after = before | added
    return fits.reduction(before, after) > sufficient(fits, before, fits.bench.on_mesh(after))


def sufficient(fits: Fits, names: Names, mesh: bool) -> float:
    """Return the reduction of the held-out mean square that a further cause has to make."""
    scatter = fits.scatters(names, mesh)
    excess = fits.excess(names, mesh, scatter)
    if not names or (is_by_tolerances(fits, names) and is_quiet(fits, names)):
        return SHARE * (excess - EXCESS_OF_COMPLETE_MODEL)
    little = LEAST * fits.excess(frozenset(), mesh, scatter)
    return max(SHARE * excess, min(little, MOST * excess))


def add(fits: Fits, names: Names, least: float = 0.0) -> list[tuple[str, Reduction]]:
    """Return each further effect that passes screening, fitted, with its gain, best first.

    `least` is the reduction of the mean square that the effects have to make. Beside an effect that
    does what tolerances do as well, others explain what those leave. A wave that is longer
    than the strokes is left out, since no name could be proven.
    """
    screened = fits.screen(names)
    of_best = least_part(screened) * (1.0 - fits.of_tolerances(names))
    part = max(of_best, _least_part(fits, names, least))
    candidates = [s for s in screened if s.part >= part]
    fits.step.ahead(sum(fits.is_new(names | {s.effect.name}) for s in candidates))
    found = []
    for s in candidates:
        together = names | {s.effect.name}
        fits.fit(names, together, s)
        if not _is_part_of_a_wave(fits.bench, fits.trial(together), s.effect):
            found.append((s.effect.name, fits.gain(names, together)))
    return sorted(found, key=lambda f: -f[1].part)


def _is_part_of_a_wave(bench: Bench, trial: HypothesisFit, effect: Effect) -> bool:
    """Return whether an effect is a wave that the strokes do not repeat: any curve is."""
    if effect.period is None:
        return False
    return REPEATS * trial.values()[effect.period] > bench.longest_stroke_mm


def _better(fits: Fits, names: Names) -> list[Names]:
    """Return the extended sets: with the simplest effect, and with the best if it differs."""
    fitted = add(fits, names, sufficient(fits, names, fits.bench.on_mesh(names)))
    convinces = _criterion(fits, names)
    singles = [
        (name, found)
        for name, found in fitted
        if convinces(found) and matters(fits, names, frozenset({name}))
    ]
    if singles:
        branches = dict.fromkeys((_simplest(fits, names, singles), singles[0][0]))
        return [names | {name} for name in branches]
    pair = _best_pair(fits, names, convinces) if len(names) + 2 <= MOST_EFFECTS else None
    return [] if pair is None else [names | pair]


def _simplest(fits: Fits, names: Names, singles: list[tuple[str, Reduction]]) -> str:
    """Return the best effect, or one with fewer parameters that is not significantly worse."""
    best = singles[0][0]
    count = {e.name: len(e.parameters) for e in fits.effects}
    for name, _ in sorted(singles, key=lambda s: count[s[0]]):
        if count[name] >= count[best]:
            break
        if not fits.gain(names | {name}, names | {best}).beyond(LEAST_REDUCTION_PER_COMPLEXITY):
            return name
    return best


def _criterion(fits: Fits, names: Names) -> Criterion:
    """Return whether a further effect convinces, by what its predecessors leave."""
    if (names and not is_by_tolerances(fits, names)) or not is_quiet(fits, names):
        return attrgetter("convincing")
    below = not names and held_out_mean_square(fits, names) < 1.0
    return attrgetter("convincing_of_any" if below else "convincing_of_noise")


def _best_pair(fits: Fits, names: Names, convinces: Criterion) -> Names | None:
    """Return two effects that are significant only together."""
    screened = fits.screen(names)
    part_of_both = _least_part(fits, names, sufficient(fits, names, fits.bench.on_mesh(names)))
    pairs = list(combinations(screened, 2))
    meshes = [fits.bench.on_mesh([*names, a.effect.name, b.effect.name]) for a, b in pairs]
    explained = {
        mesh: parts_of_pairs(screened, fits.trial(names, on_mesh=mesh).solution.residual)
        for mesh in sorted(set(meshes))
    }
    parts = []
    for k, ((a, b), mesh) in enumerate(zip(pairs, meshes, strict=True)):
        part = explained[mesh][k]
        if part >= part_of_both:
            parts.append((part - a.part - b.part, a, b))
    parts.sort(key=lambda p: -p[0])
    for surplus, a, b in parts[:PAIRS]:
        if surplus < LEAST_REDUCTION:
            break
        pair = frozenset({a.effect.name, b.effect.name})
        fits.step.ahead(fits.is_new(names | pair))
        fits.fit(names, names | pair, a, b)
        found = fits.gain(names, names | pair)
        if convinces(found) and matters(fits, names, pair):
            return pair
    return None


def _without_redundant(fits: Fits, names: Names) -> Names:
    """Return the set without effects that are redundant, removed one by one."""
    for name in sorted(names):
        fewer = names - {name}
        if fewer and not fits.gain(fewer, names).convincing:
            return _without_redundant(fits, fewer)
    return names


def _least_part(fits: Fits, names: Names, reduction: float) -> float:
    """Return the share of the squares that a signature explains at least, for a reduction."""
    return LINEAR * reduction / fits.trial(names).mean_square
