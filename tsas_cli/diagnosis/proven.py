"""The effects of a search that prove to be causes: tested, dropped one by one, fitted again."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.constancy import Split, absorbed_by, beside_tolerances, worst_split
from tsas_cli.diagnosis.evidence import LEAST_REDUCTION, gain, gain_percent
from tsas_cli.diagnosis.friction_scatter import scatter_is_no_effect, within_scatter
from tsas_cli.diagnosis.held_out import predicted_folds
from tsas_cli.diagnosis.hypotheses import Hypotheses, judged_sets, reweighted_hypotheses
from tsas_cli.diagnosis.intervals import Tolerated, estimates_with_tolerances
from tsas_cli.diagnosis.proof import (
    ANOTHER_LAW,
    BY_NAME,
    MOST_OF_A_SENSOR,
    FoundCause,
    failures,
    is_harmonic,
    may_be_of_the_law_of,
    may_be_zero,
    of_one_size,
    sensors_of,
    split_in_words,
)
from tsas_cli.diagnosis.refitted import HeldOutFit, refitted
from tsas_cli.diagnosis.remainder import Remainder, remainder, remainder_of, share_left
from tsas_cli.diagnosis.signals import signal_in_words, signals_at_residuals
from tsas_cli.diagnosis.tolerances import LOAD_CELL, largest_forces, tolerances, within_tolerances
from tsas_cli.effects.channel_delay import CHANNEL_DELAY
from tsas_cli.effects.sensor_lag import SENSOR_LAG
from tsas_cli.identification.estimate import Estimate
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import Steps

SEED = 1  # of the resampling of blocks
MOST_RIVALS = 2  # of an effect that fails, which are tried in its place
MOST_LEFT = 0.1  # of what could be explained, by all causes together
TIMES = (CHANNEL_DELAY.name, SENSOR_LAG.name)
OPPOSITE = 0.3  # of a lag, that a lead differs from it by at most


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

    The one that fails and gains least gives way to a rival that explains all, or is left out, and
    the others are fitted again, until none fails. What is negligible is no stand-in; nor, where
    nothing is left without it, what may be zero or gains too little.
    """
    stand_ins: tuple[FoundCause, ...] = ()
    proven = whole = _judged(search, stand_ins, step)
    while failing := [cause for cause in proven.causes if cause.failed]:
        weakest = min(failing, key=lambda cause: cause.gain_percent)
        instead = _with_a_rival(search, weakest, stand_ins, step)
        if instead is not None:
            proven = instead
            break
        if not weakest.negligible:
            stand_ins = (*stand_ins, weakest)
        rest = {name: r for name, r in search.rivals.items() if name != weakest.effect}
        search = replace(search, named=frozenset(rest), rivals=rest)
        proven = _judged(search, stand_ins, step)
    if proven.after.complete:
        stand_ins = tuple(
            cause
            for cause in stand_ins
            if cause.convincing and not may_be_zero(cause.effect, cause.parameters)
        )
    return replace(proven, stand_ins=stand_ins, whole=whole)


def _with_a_rival(
    search: Hypotheses, failing: FoundCause, stand_ins: tuple[FoundCause, ...], step: Steps
) -> Proven | None:
    """Return the effects with a rival in the place of one that fails.

    None where one of them is not proven then by the catalogue's law, or more than noise is left.
    """
    for other in failing.rivals[:MOST_RIVALS]:
        rivals = {name: r for name, r in search.rivals.items() if name != failing.effect}
        rivals[other] = tuple(name for name in failing.rivals if name != other)
        instead = replace(search, named=frozenset(rivals), rivals=rivals)
        proven = _judged(instead, stand_ins, step)
        doubtful = any(cause.failed or cause.law_differs for cause in proven.causes)
        if proven.after.complete and not doubtful:
            return proven
    return None


def _judged(search: Hypotheses, stand_ins: tuple[FoundCause, ...], step: Steps) -> Proven:
    """Return the effects of a set with what each does not prove, fitted with the final weights."""
    judged = reweighted_hypotheses(search, step) if search.named else search
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
    causes = tuple(_beside_another_law(cause, causes) for cause in causes)
    causes = tuple(_beside_a_wave(cause, causes) for cause in causes)
    causes = tuple(_beside_its_opposite(cause, causes) for cause in causes)
    gaining = (*causes, *stand_ins)
    causes = tuple(_beside_others_of_its_sensor(cause, gaining) for cause in causes)
    start = after
    if named:
        start = remainder_of(bench, judged.trial(frozenset(), on_mesh=mesh), judged.folds)
    causes = tuple(
        _beside_what_is_left(cause, start, after, bench.sample_interval_s) for cause in causes
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
    again = gain(fewer.squares, all_of_them.squares)
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
    if split is not None and (much_left or (law and not of_one_size(split))):
        failed, law = (f"is not constant {split_in_words(split)}", *failed), ""
    interval = gains[1], gains[2]
    negligible = not again.convincing and (zero or again.part < LEAST_REDUCTION)
    reduction = float(fewer.squares.sum() - all_of_them.squares.sum())
    if within_tolerances(judged.trial(named), name, last.tolerated, reduction):
        failed, negligible = (*failed, "is no more than a tolerance of load cells and bend"), True
    if within_scatter(judged.trial(named), name, judged.folds.run):
        failed, negligible = (*failed, "is no more than a friction that differs by run"), True
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


def _beside_another_law(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where one that gains more acts at its place by a law of its own.

    What that law lacks, a curve of another kind of a sensor or a wave, is no cause of its own.
    """
    for other in causes:
        alike = may_be_of_the_law_of(cause.effect, other.effect)
        if other.law_differs and alike and other.gain_percent > cause.gain_percent:
            title = BY_NAME[other.effect].title.lower()
            said = f"acts where {title} does, whose law differs from the catalogue's"
            return replace(cause, failed=(*cause.failed, said))
    return cause


def _beside_its_opposite(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a delay or a low pass, refused where a channel leads by as much as it lags.

    Together they round its corners alone, which is another effect's.
    """
    if cause.effect not in TIMES:
        return cause
    times = {e.name.partition(".")[2]: e.value for one in causes for e in one.parameters}
    for sensor in sorted(sensors_of(cause)):
        delay_s, lag_s = (times.get(f"{sensor}_{kind}_s", 0.0) for kind in ("delay", "lag"))
        if lag_s > 0.0 and abs(delay_s + lag_s) < OPPOSITE * lag_s:
            said = (
                f"is undone in {sensor}, which leads by {-delay_s:.2g} s and lags by {lag_s:.2g} s"
            )
            return replace(cause, failed=(*cause.failed, said))
    return cause


def _beside_others_of_its_sensor(cause: FoundCause, gaining: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where many effects that gain are errors of the same sensor."""
    for sensor in sorted(sensors_of(cause)):
        errors = sum(sensor in sensors_of(other) for other in gaining)
        if errors > MOST_OF_A_SENSOR:
            said = f"is one of {errors} errors of the {sensor} sensor, which may be one law of it"
            return replace(cause, failed=(*cause.failed, said))
    return cause


def _beside_a_wave(cause: FoundCause, causes: Sequence[FoundCause]) -> FoundCause:
    """Return a cause, refused where it may be a harmonic of a wave that gains more."""
    for other in causes:
        periods = [
            estimate.value
            for one in (cause, other)
            for estimate in one.parameters
            if estimate.name == BY_NAME[one.effect].period
        ]
        waves = len(periods) == 2 and other.gain_percent > cause.gain_percent
        if waves and is_harmonic(*periods):
            said = f"may be a harmonic of {BY_NAME[other.effect].title.lower()}"
            return replace(cause, failed=(*cause.failed, said))
    return cause


def _beside_what_is_left(
    cause: FoundCause, start: Remainder, after: Remainder, interval_s: float
) -> FoundCause:
    """Return a cause, refused where much is left: an effect that is alike may take the rest too.

    A delay by less than half a sample interval is where anything is left: what is wrong at each
    reversal looks so.
    """
    if after.complete:
        return cause
    failed, left = list(cause.failed), share_left(start, after)
    if left > MOST_LEFT:
        failed.append(f"leaves {100.0 * left:.0f} % of what could be explained")
    if cause.effect == CHANNEL_DELAY.name and all(
        abs(e.value) < 0.5 * interval_s for e in cause.parameters
    ):
        failed.append("is less than half a sample interval, and more is wrong")
    return replace(cause, failed=tuple(failed))


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
