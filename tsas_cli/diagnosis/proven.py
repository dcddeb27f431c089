"""The effects of a search that prove to be causes: tested, dropped one by one, fitted again."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.channel_errors import noise_floor
from tsas_cli.diagnosis.constancy import absorbed_by, beside_tolerances, worst_split
from tsas_cli.diagnosis.evidence import gain, gain_percent
from tsas_cli.diagnosis.held_out import predicted_folds
from tsas_cli.diagnosis.hypotheses import Hypotheses, judged_sets, reweighted_hypotheses
from tsas_cli.diagnosis.proof import (
    ANOTHER_LAW,
    BY_NAME,
    FoundCause,
    failures,
    may_be_zero,
    split_in_words,
)
from tsas_cli.diagnosis.refitted import HeldOutFit, refitted
from tsas_cli.diagnosis.remainder import Remainder, remainder
from tsas_cli.diagnosis.signals import signal_in_words, signals_at_residuals
from tsas_cli.diagnosis.tolerances import (
    LOAD_CELL,
    covariance_of_tolerances,
    largest_forces,
    of_others,
    tolerances,
    within_scatter,
    within_tolerances,
)
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import HypothesisFit, correlation_of
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.joint_fit import estimates_of
from tsas_cli.records.base import TWO_SIDED
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import Steps

SEED = 1  # of the resampling of blocks
SHEATH = "sheath_compression.compliance_ratio"


@dataclass(frozen=True, eq=False)
class Proven:
    """The effects that prove to be causes, with their fits, and those that do not.

    `judged` has the fits with the final weights, `held_out` the errors of each on held-out data,
    `after` what remains;
    `with_stand_ins` are the estimates with all effects that gain.
    """

    search: Hypotheses
    judged: Hypotheses
    causes: tuple[FoundCause, ...]
    stand_ins: tuple[FoundCause, ...]
    estimates: tuple[Estimate, ...]
    held_out: Mapping[frozenset[str], HeldOutFit]
    after: Remainder
    with_stand_ins: tuple[Estimate, ...] = ()


def proven_effects(search: Hypotheses, step: Steps) -> Proven:
    """Return the effects of a search that prove to be causes, and those that do not.

    The one that fails and gains least is left out, and the others are fitted again, until none
    fails. What is negligible is no stand-in; nor, where nothing is left without it, what may be
    zero or gains too little.
    """
    stand_ins: list[FoundCause] = []
    first: tuple[Estimate, ...] | None = None
    while True:
        judged = reweighted_hypotheses(search, step) if search.named else search
        proven = _judged(search, judged, tuple(stand_ins))
        first = first or proven.estimates
        failing = [cause for cause in proven.causes if cause.failed]
        if not failing:
            if proven.after.complete:
                kept = [
                    cause
                    for cause in stand_ins
                    if cause.convincing and not may_be_zero(cause.effect, cause.parameters)
                ]
                proven = replace(proven, stand_ins=tuple(kept))
            return replace(proven, with_stand_ins=first)
        weakest = min(failing, key=lambda cause: cause.gain_percent)
        if not weakest.negligible:
            stand_ins.append(weakest)
        rest = {name: r for name, r in search.rivals.items() if name != weakest.effect}
        search = replace(search, named=frozenset(rest), rivals=rest)


def _judged(search: Hypotheses, judged: Hypotheses, stand_ins: tuple[FoundCause, ...]) -> Proven:
    """Return the effects of a set with what each does not prove, from the final weights."""
    bench, named = judged.bench, judged.named
    mesh = bench.on_mesh(named)
    final = judged.trial(named)
    folds = predicted_folds(final, judged.folds)
    held_out = {
        names: refitted(bench, judged.trial(names, on_mesh=mesh), folds)
        for names in judged_sets(named)
    }
    at_residuals = signals_at_residuals(bench, final)
    tolerated = tolerances(bench, final)
    estimates, correlation = estimates_with_tolerances(judged, final, tolerated)
    after = remainder(bench, final, judged.folds, at_residuals, tolerated)
    last = _LastFit(
        judged, estimates, correlation, held_out, at_residuals.signals, after.structure, tolerated
    )
    causes = tuple(_cause(last, name) for name in judged.rivals)
    return Proven(search, judged, causes, stand_ins, tuple(estimates), held_out, after)


@dataclass(frozen=True, eq=False)
class _LastFit:
    """The fit of the final set, by which each of its effects is judged."""

    judged: Hypotheses
    estimates: Sequence[Estimate]
    correlation: Floats  # of all estimates, shape (p, p)
    held_out: Mapping[frozenset[str], HeldOutFit]
    signals: dict[str, Floats]
    structure: float  # squares that the set leaves and a regression explains
    tolerated: Floats  # what tolerances change, shape (n, m)


def _cause(last: _LastFit, name: str) -> FoundCause:
    """Return an effect of the final set, with what it does not prove."""
    judged, estimates, held_out, signals = last.judged, last.estimates, last.held_out, last.signals
    named = judged.named
    fewer, all_of_them = held_out[named - {name}], held_out[named]
    gains = gain_percent(fewer.squares, all_of_them.squares, np.random.default_rng(SEED))
    at = [k for k, e in enumerate(estimates) if e.name.startswith(f"{name}.")]
    own = tuple(estimates[k] for k in at)
    ids = tuple(run.run.run.id for run in judged.bench.closed)
    split = worst_split(judged.trial(named), name, judged.folds, signals, ids, last.tolerated)
    again = gain(fewer.squares, all_of_them.squares)
    related = last.correlation[np.ix_(at, at)]
    noise = {channel: noise_floor(judged.bench, channel, 0.0) for channel in fewer.rmse}
    stroke_mm = float(np.ptp(signals["x_in_mm"])) if "x_in_mm" in signals else math.inf
    failed = failures(
        *(name, own, again, fewer.rmse, all_of_them.rmse, noise),
        tolerance_N={n: LOAD_CELL * size for n, size in largest_forces(judged.bench).items()},
        stroke_mm=stroke_mm,
        correlation=related,
    )
    failed = (*failed, *_of_another_law(last, name))
    law = "" if split is None else split_in_words(split)
    excess = float(fewer.squares.sum()) - judged.folds.block.size
    if split is not None and last.structure > ANOTHER_LAW * excess:
        failed, law = (f"is not constant {law}", *failed), ""
    interval = gains[1], gains[2]
    negligible = not again.convincing and may_be_zero(name, own, related)
    reduction = float(fewer.squares.sum() - all_of_them.squares.sum())
    if within_tolerances(judged.trial(named), name, last.tolerated, reduction):
        failed, negligible = (*failed, "is no more than a tolerance of load cells and bend"), True
    if within_scatter(judged.trial(named), name, judged.folds.run):
        failed, negligible = (*failed, "is no more than a friction that differs by run"), True
    return FoundCause(
        *(name, judged.rivals[name], own, gains[0], interval, failed, law),
        convincing=again.convincing,
        negligible=negligible,
    )


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


def estimates_with_tolerances(
    search: Hypotheses, trial: HypothesisFit, tolerated: Floats
) -> tuple[list[Estimate], Floats]:
    """Return the estimates of a trial and their correlation, with what tolerances change."""
    solution = trial.solution
    counted = search.folds.blocks_of_runs(len(search.bench.rigs))
    fitted = with_errors(trial.unknowns, solution, counted, by_run=True)
    by_tolerances = covariance_of_tolerances(trial, of_others(trial, tolerated), counted)
    known = np.where(np.isfinite(fitted.stderr), fitted.stderr, 0.0)
    by_noise = trial.correlation() * np.outer(known, known)
    fitted = replace(fitted, stderr=np.hypot(fitted.stderr, np.sqrt(np.diag(by_tolerances))))
    estimates = estimates_of(trial.unknowns, fitted, search.bench.base.problem.ids)
    estimates = [_with_data_sheet_interval(e, trial) if e.name == SHEATH else e for e in estimates]
    return estimates, correlation_of(by_noise + by_tolerances)


def _with_data_sheet_interval(ratio: Estimate, trial: HypothesisFit) -> Estimate:
    """Return the sheath's compliance with the interval that follows from the tendon's data sheet.

    The recordings determine (1 + ratio)/EA only, so the ratio is as uncertain as EA is.
    """
    EA = next((j for j, u in enumerate(trial.unknowns) if u.name == "tendon_stiffness_N"), None)
    if EA is None:
        return ratio
    unknown, fitted = trial.unknowns[EA], float(trial.solution.values[EA])
    whole = 1.0 + ratio.value
    low = max(whole * math.exp(unknown.lower - fitted) - 1.0, 0.0)
    high = whole * math.exp(unknown.upper - fitted) - 1.0
    stderr = max(high - ratio.value, ratio.value - low) / TWO_SIDED
    return replace(ratio, stderr=stderr, interval_low=low, interval_high=high)
