"""Diagnose the effects that a calibrated model lacks, from runs to a verdict."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.channel_errors import HeldOutErrors, channel_errors
from tsas_cli.diagnosis.evidence import gain_percent
from tsas_cli.diagnosis.held_out import Folds, folds_of
from tsas_cli.diagnosis.remainder import Remainder, remainder
from tsas_cli.diagnosis.search import (
    EXCESS_OF_COMPLETE_MODEL,
    Hypotheses,
    find_effects,
    reweighted_hypotheses,
)
from tsas_cli.diagnosis.signals import signal_in_words
from tsas_cli.diagnosis.uneven_bend import stderr_of_unevenness
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, HypothesisFit, bench_of
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.joint_fit import FittedModel, estimates_of, solve_fit
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.identification.preload_correction import with_preload_correction
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.support.steps import NO_PROGRESS, Steps

Floats = npt.NDArray[np.float64]
Verdict = Literal["named", "ambiguous", "sufficient", "unexplained", "undecided"]

PLAUSIBLE = 0.15  # relative deviation of a tendon's axial stiffness from its data sheet
MOST_SHARE_LEFT = 0.02  # of the initial excess over the noise, that named causes may leave
MOST_LEFT = 4.0  # mean square of the residual, twice the noise level, that causes may leave
UNEXPLAINED_SHARE = 0.5  # of the excess, beyond which the verdict is `unexplained`
NEEDS_CAUSE = 2.0 * EXCESS_OF_COMPLETE_MODEL  # excess of the mean square that needs an explanation
FEW_BLOCKS = 6  # fewer are too few for a test
SEED = 1  # of the resampling of blocks
SHEATH = "sheath_compression.compliance_ratio"


@dataclass(frozen=True)
class FoundCause:
    """A named effect, with its parameters and its reduction of the RMS on held-out data [%]."""

    effect: str
    rivals: tuple[str, ...]
    parameters: tuple[Estimate, ...]
    gain_percent: float
    gain_interval_percent: tuple[float, float]


@dataclass(frozen=True)
class Diagnosis:
    """The verdict with its evidence, which is None where it is undecided.

    `model` is the extended one, `nominal` the one without the named effects. `search` has all
    hypotheses, `judged` those fitted with the final weights, among them the nominal model `before`
    and the `final` one.
    """

    verdict: Verdict
    reason: str
    model: Model
    nominal: Model
    causes: tuple[FoundCause, ...] = ()
    channels: dict[str, HeldOutErrors] = field(default_factory=dict)
    remainder: Remainder | None = None
    share_left: float = 0.0
    search: Hypotheses | None = None
    judged: Hypotheses | None = None
    before: HypothesisFit | None = None
    final: HypothesisFit | None = None
    cannot_tell: tuple[str, ...] = ()

    @property
    def unexplained(self) -> bool:
        """Whether a residual remains that no effect explains."""
        if self.remainder is None:
            return False
        if not self.causes:
            return self.verdict == "unexplained"
        return leaves_much(self.remainder.mean_square, self.share_left)


def verdict_of(rivals: Sequence[tuple[str, ...]], mean_square: float, share: float) -> Verdict:
    """Return the verdict by the residual with the causes, and the rivals of each."""
    if not rivals:
        return "unexplained" if mean_square > 1.0 + NEEDS_CAUSE else "sufficient"
    if share > UNEXPLAINED_SHARE:
        return "unexplained"
    return "ambiguous" if any(rivals) else "named"


def leaves_much(mean_square: float, share: float) -> bool:
    """Return whether named causes leave a residual that needs a further explanation."""
    return mean_square > MOST_LEFT or (
        mean_square > 1.0 + EXCESS_OF_COMPLETE_MODEL and share > MOST_SHARE_LEFT
    )


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
    search = find_effects(bench, folds, step)
    judged = reweighted_hypotheses(search, step) if search.named else search
    found = _concluded(search, judged, base)
    extended, nominal = (with_preload_correction(m, runs) for m in (found.model, found.nominal))
    return replace(found, model=extended, nominal=nominal)


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


def _concluded(search: Hypotheses, judged: Hypotheses, base: FittedModel) -> Diagnosis:
    """Return the diagnosis from a search, and from its fits with the final weights."""
    named, model = search.named, base.model
    before = judged.trial(frozenset(), on_mesh=judged.bench.on_mesh(named))
    final = judged.trial(named)
    estimates = _estimates(judged, final)
    causes = tuple(_cause(judged, name, estimates) for name in search.rivals)
    after = remainder(judged.bench, final, judged.folds)
    start = remainder(judged.bench, before, judged.folds) if named else after
    excess = [max(r.mean_square - 1.0, 0.0) for r in (start, after)]
    share = max(excess[1] - EXCESS_OF_COMPLETE_MODEL, 0.0) / excess[0] if excess[0] > 0.0 else 0.0
    verdict = verdict_of([cause.rivals for cause in causes], after.mean_square, share)
    extended = Model(tuple(estimates)).over(model)
    nominal = Model(tuple(_estimates(judged, before))).over(model) if named else extended
    found = Diagnosis(
        verdict,
        "",
        extended,
        nominal,
        causes,
        channel_errors(judged, before, final, start, after),
        after,
        share if named else 1.0,
        search,
        judged,
        before,
        final,
        base.not_identifiable,
    )
    return replace(found, reason=_reason(found, start, after))


def _cause(judged: Hypotheses, name: str, estimates: Sequence[Estimate]) -> FoundCause:
    named = judged.named
    gains = gain_percent(
        judged.held_out(named - {name}, on_mesh=judged.bench.on_mesh(named)),
        judged.held_out(named),
        np.random.default_rng(SEED),
    )
    own = tuple(e for e in estimates if e.name.startswith(f"{name}."))
    return FoundCause(name, judged.rivals[name], own, gains[0], (gains[1], gains[2]))


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


def _reason(found: Diagnosis, start: Remainder, after: Remainder) -> str:
    """Return the verdict in a few plain sentences."""
    titles = {effect.name: effect.title.lower() for effect in EFFECTS}
    names = " and ".join(titles[c.effect] for c in found.causes)
    rms = [_two_digits(math.sqrt(r.mean_square)) for r in (start, after)]
    depends = ", ".join(signal_in_words(signal) for signal in after.depends_on)
    depends = f" It depends on {depends}." if depends else ""
    if found.verdict == "sufficient":
        return "The nominal model is at the noise level: these runs show no missing effect."
    if not found.causes:
        return (
            f"The residual RMS is {rms[0]} × the noise level, and no catalogued effect explains "
            f"it.{depends}"
        )
    sentences = f"The nominal model lacks: {names}. "
    sentences += f"With it the residual RMS falls from {rms[0]} to {rms[1]} × the noise level."
    rivals = sorted({titles[r] for c in found.causes for r in c.rivals})
    if rivals:
        sentences += f" Indistinguishable from it in these recordings: {', '.join(rivals)}."
    if found.verdict == "unexplained":
        return f"{sentences} No catalogued effect explains most of the remaining residual.{depends}"
    if found.unexplained:
        return f"{sentences} No catalogued effect explains the remaining residual.{depends}"
    return sentences


def _two_digits(value: float) -> str:
    return f"{value:#.2g}" if value < 9.95 else f"{float(f'{value:.2g}'):.0f}"
