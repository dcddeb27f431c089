"""Diagnose the effects that a calibrated model lacks, from runs to a verdict."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.channel_errors import HeldOutErrors, channel_errors, noise_floor
from tsas_cli.diagnosis.constancy import worst_split
from tsas_cli.diagnosis.evidence import gain, gain_percent
from tsas_cli.diagnosis.held_out import Folds, folds_of, predicted_folds
from tsas_cli.diagnosis.proof import ANOTHER_LAW, FoundCause, failures, split_in_words
from tsas_cli.diagnosis.reason import reason_of
from tsas_cli.diagnosis.refitted import HeldOutFit, refitted
from tsas_cli.diagnosis.remainder import Remainder, remainder
from tsas_cli.diagnosis.search import (
    Hypotheses,
    find_effects,
    judged_sets,
    reweighted_hypotheses,
)
from tsas_cli.diagnosis.signals import signals_at_residuals
from tsas_cli.diagnosis.uneven_bend import stderr_of_unevenness
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.calibration import with_preload_correction
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, HypothesisFit, bench_of
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.joint_fit import FittedModel, estimates_of, solve_fit
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.diagnosis import Verdict
from tsas_cli.support.steps import NO_PROGRESS, Steps

Floats = npt.NDArray[np.float64]

PLAUSIBLE = 0.15  # relative deviation of a tendon's axial stiffness from its data sheet
FEW_BLOCKS = 6  # fewer are too few for a test
SEED = 1  # of the resampling of blocks
SHEATH = "sheath_compression.compliance_ratio"


@dataclass(frozen=True)
class Diagnosis:
    """The verdict with its evidence, which is None where it is undecided.

    `model` is the extended one, `nominal` the one without the named effects, `stand_in_model` that
    with all effects that gain, proven or not, where some are not. `search` has all
    hypotheses, `judged` those fitted with the final weights, among them the nominal model `before`
    and the `final` one.
    """

    verdict: Verdict
    reason: str
    model: Model
    nominal: Model
    causes: tuple[FoundCause, ...] = ()
    stand_ins: tuple[FoundCause, ...] = ()
    channels: dict[str, HeldOutErrors] = field(default_factory=dict)
    remainder: Remainder | None = None
    share_left: float = 0.0
    search: Hypotheses | None = None
    judged: Hypotheses | None = None
    before: HypothesisFit | None = None
    final: HypothesisFit | None = None
    cannot_tell: tuple[str, ...] = ()
    stand_in_model: Model | None = None

    @property
    def unexplained(self) -> bool:
        """Whether a residual remains that no effect explains."""
        return self.verdict in ("partly", "stand_in", "unexplained")


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


def verdict_of(
    rivals: Sequence[tuple[str, ...]], stand_ins: Sequence[str], *, complete: bool
) -> Verdict:
    """Return the verdict by the rivals of each proven effect, the stand-ins, and what remains.

    `complete` is whether only noise remains.
    """
    if not rivals:
        if stand_ins:
            return "stand_in"
        return "sufficient" if complete else "unexplained"
    if stand_ins or not complete:
        return "partly"
    return "ambiguous" if any(rivals) else "named"


def diagnose_runs(
    manifest: Manifest,
    stated: Model,
    runs: Sequence[Prepared],
    step: Steps = NO_PROGRESS,
) -> Diagnosis:
    """Return the effects that a model of these runs lacks; `step` reports progress.

    Parameters
    ----------
    manifest
        The data sheet.
    stated
        The data sheet as a model, or another initial model.
    runs
        The runs, prepared.
    """
    step.ahead(1)
    base = solve_fit(nominal_fit(manifest, stated, runs))
    step()
    model, cannot_tell = base.model, tuple(base.cannot_tell)
    reason = _not_possible(base)
    if reason is not None:
        return Diagnosis("undecided", reason, model, model, cannot_tell=cannot_tell)
    bench = bench_of(base)
    folds = bench_folds(bench)
    if folds.blocks < FEW_BLOCKS:
        reason = f"only {folds.blocks} independent stretches: too few for a diagnosis."
        return Diagnosis("undecided", reason, model, model, cannot_tell=cannot_tell)
    found = _concluded(_proven(find_effects(bench, folds, step), step), base)
    extended, nominal = (with_preload_correction(m, runs) for m in (found.model, found.nominal))
    whole = found.stand_in_model
    whole = None if whole is None else with_preload_correction(whole, runs)
    return replace(found, model=extended, nominal=nominal, stand_in_model=whole)


def nominal_fit(manifest: Manifest, stated: Model, runs: Sequence[Prepared]) -> FitProblem:
    """Return the fit of the nominal parameters; the tendon is bounded by its data sheet."""
    segments = [segment(run) for run in runs]
    measured = [slopes_of(run, parts) for run, parts in zip(runs, segments, strict=True)]
    plausible = {}
    stiffness = data_sheet(manifest).value("tendon_stiffness_N")
    if stiffness is not None:
        bounds = stiffness * (1.0 - PLAUSIBLE), stiffness / (1.0 - PLAUSIBLE)
        plausible["tendon_stiffness_N"] = bounds
    return base_fit(stated, runs, segments, measured, plausible)


def _not_possible(base: FittedModel) -> str | None:
    """Return the reason why no diagnosis is possible, or None."""
    fitted = base.fitted
    if not base.problem.runs:
        return "no run lasts beyond its first full slip, before which its history matters."
    if fitted is None:
        return "no parameter of the nominal model is identifiable from these recordings."
    if not fitted.converged:
        return f"the fit of the nominal model did not converge ({fitted.message})."
    return None


def bench_folds(bench: Bench) -> Folds:
    """Return the folds of a bench's runs, in blocks longer than the autocorrelation."""
    return folds_of(blocks_of(bench.closed, bench.rigs))


def _proven(search: Hypotheses, step: Steps) -> Proven:
    """Return the effects of a search that prove to be causes, and those that do not.

    The one that fails and gains least is left out, and the others are fitted again, until none
    fails. Scatter of the friction from run to run is no stand-in: every rig has it.
    """
    stand_ins: list[FoundCause] = []
    first: tuple[Estimate, ...] | None = None
    while True:
        judged = reweighted_hypotheses(search, step) if search.named else search
        proven = _judged(search, judged, tuple(stand_ins))
        first = first or proven.estimates
        failing = [cause for cause in proven.causes if cause.failed]
        if not failing:
            return replace(proven, with_stand_ins=first)
        weakest = min(failing, key=lambda cause: cause.gain_percent)
        if not weakest.scatter:
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
    estimates = _estimates(judged, final)
    at_residuals = signals_at_residuals(bench, final)
    after = remainder(bench, final, judged.folds, at_residuals)
    causes = tuple(
        _cause(judged, name, estimates, held_out, at_residuals.signals, after.structure)
        for name in judged.rivals
    )
    return Proven(search, judged, causes, stand_ins, tuple(estimates), held_out, after)


def _concluded(proven: Proven, base: FittedModel) -> Diagnosis:
    """Return the diagnosis from the effects that prove to be causes."""
    judged, causes, stand_ins = proven.judged, proven.causes, proven.stand_ins
    bench, folds, named = judged.bench, judged.folds, judged.named
    before = judged.trial(frozenset(), on_mesh=bench.on_mesh(named))
    final = judged.trial(named)
    after = start = proven.after
    if named:
        start = remainder(bench, before, folds, signals_at_residuals(bench, before))
    complete = after.complete and not any(cause.law_differs for cause in causes)
    verdict = verdict_of(
        [cause.rivals for cause in causes],
        [cause.effect for cause in stand_ins],
        complete=complete,
    )
    errors = proven.held_out[frozenset()].rmse, proven.held_out[named].rmse
    return Diagnosis(
        verdict,
        reason_of(verdict, causes, stand_ins, start, after),
        Model(proven.estimates).over(base.model),
        Model(tuple(_estimates(judged, before))).over(base.model),
        causes,
        stand_ins,
        channel_errors(bench, *errors, start, after),
        after,
        _share_left(start, after),
        proven.search,
        judged,
        before,
        final,
        base.not_identifiable,
        Model(proven.with_stand_ins).over(base.model) if stand_ins else None,
    )


def _share_left(start: Remainder, after: Remainder) -> float:
    """Return the share of what could be explained at first that remains, 0 to 1."""
    floor = after.mean_square - after.reducible
    first = max(start.mean_square - floor, 0.0)
    return min(after.reducible / first, 1.0) if first > 0.0 else 0.0


def _cause(
    judged: Hypotheses,
    name: str,
    estimates: Sequence[Estimate],
    held_out: Mapping[frozenset[str], HeldOutFit],
    signals: dict[str, Floats],
    structure: float,
) -> FoundCause:
    """Return an effect of the final set, with what it does not prove.

    `structure` are the squares that the final set leaves and a regression explains.
    """
    named = judged.named
    fewer, all_of_them = held_out[named - {name}], held_out[named]
    gains = gain_percent(fewer.squares, all_of_them.squares, np.random.default_rng(SEED))
    own = tuple(e for e in estimates if e.name.startswith(f"{name}."))
    ids = tuple(run.run.run.id for run in judged.bench.closed)
    split = worst_split(judged.trial(named), name, judged.folds, signals, ids)
    again = gain(fewer.squares, all_of_them.squares)
    related = judged.trial(named).correlation([e.name for e in own])
    noise = {channel: noise_floor(judged.bench, channel, 0.0) for channel in fewer.rmse}
    failed = failures(name, own, again, fewer.rmse, all_of_them.rmse, noise, related)
    law = "" if split is None else split_in_words(split)
    excess = float(fewer.squares.sum()) - judged.folds.block.size
    if split is not None and structure > ANOTHER_LAW * excess:
        failed, law = (f"is not constant {law}", *failed), ""
    interval = gains[1], gains[2]
    scatter = split is not None and split.scatter
    return FoundCause(name, judged.rivals[name], own, gains[0], interval, failed, law, scatter)


def _estimates(search: Hypotheses, trial: HypothesisFit) -> list[Estimate]:
    """Return the estimates of a trial, with intervals that include an uneven bend."""
    solution = trial.solution
    blocks = [search.folds.block[search.folds.run == k] for k in range(len(search.bench.rigs))]
    counted = [np.unique(block, return_inverse=True)[1] for block in blocks]
    fitted = with_errors(trial.unknowns, solution, counted, by_run=True)
    uneven = stderr_of_unevenness(search.bench, trial, counted)
    fitted = replace(fitted, stderr=np.hypot(fitted.stderr, uneven))
    estimates = estimates_of(trial.unknowns, fitted, search.bench.base.problem.ids)
    return [_with_data_sheet_interval(e, trial) if e.name == SHEATH else e for e in estimates]


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
    stderr = max(high - ratio.value, ratio.value - low) / 1.96
    return replace(ratio, stderr=stderr, interval_low=low, interval_high=high)
