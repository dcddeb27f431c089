"""The effects of a search that prove to be causes: tested, dropped one by one, fitted again."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.beside_others import (
    beside_each_other,
    beside_what_is_left,
    may_be_anywhere,
)
from tsas_cli.diagnosis.constancy import Split, absorbed_by, beside_tolerances, worst_split
from tsas_cli.diagnosis.evidence import LEAST_REDUCTION, gain_percent
from tsas_cli.diagnosis.friction_scatter import scatter_is_no_effect, within_scatter
from tsas_cli.diagnosis.held_out import predicted_folds
from tsas_cli.diagnosis.hypotheses import Hypotheses, judged_sets, reweighted_hypotheses
from tsas_cli.diagnosis.intervals import Tolerated, estimates_with_tolerances
from tsas_cli.diagnosis.proof import (
    ANOTHER_LAW,
    BY_NAME,
    FoundCause,
    failures,
    may_be_zero,
    split_in_words,
)
from tsas_cli.diagnosis.refitted import HeldOutFit, gain_anywhere, refitted
from tsas_cli.diagnosis.remainder import Remainder, remainder, remainder_of
from tsas_cli.diagnosis.rivals import leaving_noise, rivals_within
from tsas_cli.diagnosis.signals import signal_in_words, signals_at_residuals
from tsas_cli.diagnosis.tolerances import (
    LOAD_CELL,
    PRESLIDING,
    largest_forces,
    scale_is_tolerated,
    tolerances,
    within_tolerances,
    zeros_are_tolerated,
)
from tsas_cli.diagnosis.tolerated_travel import is_tolerated, with_tolerated_travel
from tsas_cli.effects.force_sensor_drift import FORCE_SENSOR_DRIFT
from tsas_cli.effects.position_sensor_gain import POSITION_SENSOR_GAIN
from tsas_cli.identification.estimate import Estimate
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import Steps

SEED = 1  # of the resampling of blocks
MOST_INSTEAD = 2  # effects that are tried in the place of one that fails


@dataclass(frozen=True, eq=False)
class Proven:
    """The effects that prove to be causes, with their fits, and those that do not.

    `judged` has the fits with the final weights, `held_out` the errors of each on held-out data,
    `start` is what remains without them and `after` what remains with them. `tolerated` is what one
    standard deviation of each tolerance changes in the fit of the causes, shape (n, m). `whole` is
    the set of all effects that gain, as it was judged.
    """

    search: Hypotheses
    judged: Hypotheses
    causes: tuple[FoundCause, ...]
    stand_ins: tuple[FoundCause, ...]
    estimates: tuple[Estimate, ...]
    held_out: Mapping[frozenset[str], HeldOutFit]
    start: Remainder
    after: Remainder
    tolerated: Floats
    whole: "Proven | None" = None


def proven_effects(search: Hypotheses, step: Steps) -> Proven:
    """Return the effects of a search that prove to be causes, and those that do not.

    The one that fails and gains least gives way to another that explains all, or is left out, and
    the others are fitted again, until none fails. What is negligible is no stand-in; nor, where
    nothing is left without it, what may be zero or gains too little.
    """
    stand_ins: tuple[FoundCause, ...] = ()
    proven = whole = _judged(search, stand_ins, step)
    while failing := [cause for cause in proven.causes if cause.failed]:
        weakest = min(failing, key=lambda cause: cause.gain_percent)
        instead = _with_another(search, proven, weakest, step)
        if instead is not None:
            proven = instead
            break
        if not weakest.negligible:
            stand_ins = (*stand_ins, weakest)
        named = search.named - {weakest.effect}
        rivals = {
            name: tuple(dict.fromkeys((*search.rivals[name], *rivals_within(search, named, name))))
            for name in search.rivals
            if name in named
        }
        search = replace(search, named=named, rivals=rivals)
        proven = _judged(search, stand_ins, step)
    if proven.after.complete:
        stand_ins = tuple(
            cause
            for cause in stand_ins
            if cause.convincing and not may_be_zero(cause.effect, cause.parameters)
        )
    return replace(proven, stand_ins=stand_ins, whole=whole)


def _with_another(
    search: Hypotheses, proven: Proven, failing: FoundCause, step: Steps
) -> Proven | None:
    """Return the effects with another in the place of one that fails, None where none is better.

    It is a rival, or leaves noise alone. All of them have to be proven then by the catalogue's law,
    and to leave noise alone, or less than the failing one does.
    """
    if may_be_anywhere((failing.effect, *failing.rivals)):
        return None
    others = (*failing.rivals, *leaving_noise(search, search.named, failing.effect))
    for other in tuple(dict.fromkeys(others))[:MOST_INSTEAD]:
        rivals = {name: r for name, r in search.rivals.items() if name != failing.effect}
        rivals[other] = tuple(name for name in failing.rivals if name != other)
        instead = replace(search, named=frozenset(rivals), rivals=rivals)
        found = _judged(instead, proven.stand_ins, step)
        doubtful = any(cause.failed or cause.law_differs for cause in found.causes)
        less = found.after.complete or found.after.mean_square < proven.after.mean_square
        if less and not doubtful:
            return found
    return None


def _judged(search: Hypotheses, stand_ins: tuple[FoundCause, ...], step: Steps) -> Proven:
    """Return the effects of a set with what each does not prove, fitted with the final weights."""
    beside = with_tolerated_travel(search)
    as_it_is = not search.named and beside is search
    judged = search if as_it_is else reweighted_hypotheses(beside, step)
    bench, named = judged.bench, judged.named
    mesh = bench.on_mesh(named)
    final = judged.trial(named)
    folds = predicted_folds(final, judged.folds)
    scatter = scatter_is_no_effect(final, judged.folds.run)
    held_out = {
        names: refitted(bench, judged.trial(names, on_mesh=mesh), folds, scatter=scatter)
        for names in judged_sets(named)
    }
    at_residuals = signals_at_residuals(bench, final)
    tolerated = tolerances(bench, final)
    found = estimates_with_tolerances(judged, final, tolerated)
    after = remainder(bench, final, judged.folds, at_residuals, tolerated)
    last = _LastFit(judged, found, held_out, at_residuals.signals, after.structure, tolerated)
    causes = tuple(_cause(last, name) for name in judged.rivals)
    causes = beside_each_other(causes, stand_ins)
    start = after
    if named:
        start = remainder_of(bench, judged.trial(frozenset(), on_mesh=mesh), judged.folds)
    causes = tuple(
        beside_what_is_left(cause, start, after, bench.sample_interval_s) for cause in causes
    )
    estimates = tuple(found.estimates)
    return Proven(search, judged, causes, stand_ins, estimates, held_out, start, after, tolerated)


@dataclass(frozen=True, eq=False)
class _LastFit:
    """The fit of the final set, by which each of its effects is judged."""

    judged: Hypotheses
    found: Tolerated
    held_out: Mapping[frozenset[str], HeldOutFit]
    signals: dict[str, Floats]
    structure: float  # squares that the set leaves and a regression explains
    tolerated: Floats  # what tolerances change, shape (n, m)


def _cause(last: _LastFit, name: str) -> FoundCause:
    """Return an effect of the final set, with what it does not prove."""
    judged, held_out, signals = last.judged, last.held_out, last.signals
    named, estimates = judged.named, last.found.estimates
    fewer, all_of_them = held_out[named - {name}], held_out[named]
    gains = gain_percent(fewer.squares, all_of_them.squares, np.random.default_rng(SEED))
    own = [e for e in estimates if e.name.startswith(f"{name}.")]
    ids = tuple(run.run.run.id for run in judged.bench.closed)
    split = worst_split(judged.trial(named), name, judged.folds, signals, ids, last.tolerated)
    again = gain_anywhere(fewer, all_of_them)
    zero = _may_be_zero(last, name)
    failed = failures(
        *(name, own, again, fewer, all_of_them),
        tolerance_N={n: LOAD_CELL * size for n, size in largest_forces(judged.bench).items()},
        stroke_mm=judged.bench.longest_stroke_mm,
        zero=zero,
    )
    failed = (*failed, *_of_another_law(last, name))
    law = "" if split is None or _within_interval(split, own) else split_in_words(split)
    excess = float(fewer.squares.sum()) - judged.folds.block.size
    much_left = last.structure > ANOTHER_LAW * excess
    if split is not None and (much_left or (law and not split.of_one_size())):
        failed, law = (f"is not constant {split_in_words(split)}", *failed), ""
    interval = gains[1], gains[2]
    negligible = not again.convincing and (zero or again.part < LEAST_REDUCTION)
    reduction = float(fewer.squares.sum() - all_of_them.squares.sum())
    if name == PRESLIDING:
        tolerated = is_tolerated(judged.bench, judged.trial(named))
    elif name == FORCE_SENSOR_DRIFT.name and zeros_are_tolerated(judged.bench, judged.trial(named)):
        tolerated = True
    elif name == POSITION_SENSOR_GAIN.name:
        tolerated = scale_is_tolerated(judged.trial(named))
    else:
        tolerated = within_tolerances(judged.trial(named), name, last.tolerated, reduction)
    if tolerated:
        failed, negligible = (*failed, "is no more than a tolerance"), True
    if within_scatter(judged.trial(named), name, judged.folds.run):
        failed, negligible = (*failed, "is no more than a friction that differs by run"), True
    if len(named) > 1 and may_be_anywhere((name, *judged.rivals[name])):
        failed = (*failed, "does what effects of the drive, tendon, load and sensors do as well")
    return FoundCause(
        *(name, judged.rivals[name], tuple(own), gains[0], interval, failed, law),
        convincing=again.convincing,
        negligible=negligible,
    )


def _may_be_zero(last: _LastFit, name: str) -> bool:
    """Return whether an effect of the final set may be zero, with its shape held.

    Without a size a shape has no meaning (Davies 1977), and few runs tell little of both.
    """
    judged, found = last.judged, last.found
    shapes = {f"{name}.{p.name}" for p in BY_NAME[name].parameters if p.shape}
    if shapes:
        held = judged.trial(judged.named).holding(shapes)
        found = estimates_with_tolerances(judged, held, last.tolerated)
    at = [k for k, e in enumerate(found.moved) if e.name.startswith(f"{name}.")]
    return may_be_zero(name, [found.moved[k] for k in at], found.correlation[np.ix_(at, at)])


def _within_interval(split: Split, estimates: Sequence[Estimate]) -> bool:
    """Return whether the values of all parts lie in the parameter's interval: none differs."""
    (whole,) = (e for e in estimates if e.name == split.parameter)
    return whole.holds(*(value for _, value in split.values))


def _of_another_law(last: _LastFit, name: str) -> Iterator[str]:
    """Yield the other effects of the set whose law may do, over some signal, what this one does."""
    judged, others = last.judged, last.judged.named - {name}
    if not others:
        return
    mesh = judged.bench.on_mesh(judged.named)
    fewer, whole = (
        beside_tolerances(judged.trial(names, on_mesh=mesh), last.tolerated)
        for names in (others, judged.named)
    )
    for other in sorted(others):
        by = absorbed_by(fewer, whole, other, judged.folds, last.signals)
        if by is not None:
            title = BY_NAME[other].title.lower()
            yield f"gains too little where {title} may differ over {signal_in_words(by)}"
