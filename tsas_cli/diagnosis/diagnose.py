"""Diagnose the effects that a calibrated model lacks, from runs to a verdict."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from tsas_cli.diagnosis.channel_errors import HeldOutErrors, channel_errors, is_far_off, with_law
from tsas_cli.diagnosis.faults.candidates import OWN_FRICTION
from tsas_cli.diagnosis.faults.rivals import effects_as_good, leaves_noise
from tsas_cli.diagnosis.faults.search import FoundFault, fault_of_recording
from tsas_cli.diagnosis.faults.words import (
    STIFFER,
    differing,
    reason_of_fault,
    record_of,
    wandering,
)
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.friction_scatter import frictions_that_explain
from tsas_cli.diagnosis.held_out import Folds, folds_of, predicted_folds
from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.diagnosis.intervals import estimates_with_tolerances
from tsas_cli.diagnosis.law import Law, describe
from tsas_cli.diagnosis.nominal import nominal_fit, stiffer_than_stated
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.proven import Proven, proven_effects
from tsas_cli.diagnosis.reason import reason_of
from tsas_cli.diagnosis.remainder import Remainder, share_left
from tsas_cli.diagnosis.rivals import find_effects
from tsas_cli.diagnosis.tolerances import frictions_of, tolerances
from tsas_cli.diagnosis.tolerated_travel import travel_notes
from tsas_cli.identification.calibration import with_preload_correction
from tsas_cli.identification.extension import Bench, bench_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import FittedModel, solve_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.diagnosis import INCOMPLETE, RecordingFault, Verdict
from tsas_cli.support.steps import NO_PROGRESS, Endable, Ended, Steps
from tsas_cli.support.wording import count_of

FEW_BLOCKS = 6  # fewer are too few for a test


@dataclass(frozen=True)
class Diagnosis:
    """The verdict with its evidence, which is None where it is undecided but for an ended `search`.

    `model` is the extended one, with the `law` that describes what the named effects leave, if one
    does; `nominal` the one without both, `stand_in_model` that with all effects that gain, proven
    or not, where some are not and no law describes them. `search` has all
    hypotheses, `judged` those fitted with the final weights, among them the nominal model `before`
    and the `final` one. `converged` is whether the fit of the nominal model did.
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
    law: Law | None = None
    fault: RecordingFault | None = None
    converged: bool = True

    @property
    def unexplained(self) -> bool:
        """Whether a residual remains that no effect explains."""
        return self.verdict in INCOMPLETE


def verdict_of(
    rivals: Sequence[tuple[str, ...]],
    stand_ins: Sequence[str],
    *,
    complete: bool,
    described: bool = False,
) -> Verdict:
    """Return the verdict by the rivals of each proven effect, the stand-ins, and what remains.

    `complete` is whether only noise remains, `described` whether a law describes what does.
    """
    if not rivals and described:
        return "described"
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
    accepted: Collection[str] = (),
) -> Diagnosis:
    """Return the effects that a model of these runs lacks; `step` reports progress.

    Where a fault of the recordings explains what the nominal model leaves, none is sought; those
    of codes that are `accepted` are not. A friction of one run's own is no fault where an effect
    that gains explains as much. `stated` is the data sheet as a model, or another initial
    model.
    """
    step.doing("fits the nominal model")
    step.ahead(1)
    bounded = STIFFER not in accepted
    base = solve_fit(nominal_fit(manifest, stated, runs, bounded=bounded))
    step()
    model, cannot_tell = base.model, tuple(base.cannot_tell)
    reason = _not_possible(base)
    if reason is not None:
        converged = base.fitted is None or base.fitted.converged
        return Diagnosis(
            "undecided", reason, model, model, cannot_tell=cannot_tell, converged=converged
        )
    bench = bench_of(base)
    folds = bench_folds(bench)
    if folds.blocks < FEW_BLOCKS:
        reason = f"Only {folds.blocks} independent stretches: too few for a diagnosis."
        return Diagnosis("undecided", reason, model, model, cannot_tell=cannot_tell)
    step = Endable(step)
    fits = Fits(bench, folds, step)
    try:
        stiffer = stiffer_than_stated(manifest, stated, base, fits.trial(frozenset()))
        if stiffer is not None:
            return _undecided_by(*stiffer, base)
        fault = fault_of_recording(fits, accepted)
        if fault is not None and not any(effects_as_good(fits, fault)):
            return _of_a_fault(fault, base)
        found = _concluded(proven_effects(find_effects(fits), step), base, step)
    except Ended:
        return _ended(fits, model, cannot_tell)
    if fault is not None:
        by_fault = _of_a_fault(fault, base)
        if _accounts_for(fault, found, fits):
            return by_fault
        if found.unexplained and not found.causes and not _explained(fault, found, fits):
            found = replace(found, fault=by_fault.fault, reason=f"{found.reason} {by_fault.reason}")
    extended, nominal = (with_preload_correction(m, runs) for m in (found.model, found.nominal))
    whole = found.stand_in_model
    whole = None if whole is None else with_preload_correction(whole, runs)
    return replace(found, model=extended, nominal=nominal, stand_in_model=whole)


def _accounts_for(fault: FoundFault, found: Diagnosis, fits: Fits) -> bool:
    """Return whether a fault of the recordings comes before what the search has found.

    It does where that is nothing, since a tolerance takes a friction of one run's own, and where
    all causes are of other laws than the catalogue's and leave more than noise.
    """
    if found.verdict == "sufficient":
        return True
    named = frozenset(cause.effect for cause in found.causes)
    of_other_laws = bool(named) and all(cause.law_differs for cause in found.causes)
    return found.unexplained and of_other_laws and not leaves_noise(fits, named, fault)


def _explained(fault: FoundFault, found: Diagnosis, fits: Fits) -> bool:
    """Return whether the fault is a friction of one run that an effect that gains explains."""
    gaining = {one.effect for one in found.stand_ins}
    of_a_friction = bool(gaining) and fault.found[0].code == OWN_FRICTION
    return of_a_friction and not gaining.isdisjoint(effects_as_good(fits, fault))


def _of_a_fault(fault: FoundFault, base: FittedModel) -> Diagnosis:
    """Return that a fault of the recordings comes before any mechanism."""
    record = record_of(fault.found, [run.run.id for run in base.problem.runs])
    return _undecided_by(record, fault.share, base)


def _undecided_by(record: RecordingFault, share: float, base: FittedModel) -> Diagnosis:
    """Return that a fault explains a share of what the nominal model leaves."""
    reason = reason_of_fault(record, share)
    cannot_tell = tuple(base.cannot_tell)
    return Diagnosis(
        "undecided", reason, base.model, base.model, cannot_tell=cannot_tell, fault=record
    )


def _ended(fits: Fits, model: Model, cannot_tell: tuple[str, ...]) -> Diagnosis:
    """Return what is known where a person has ended the search."""
    found = fits.so_far()
    fitted = {names for names, _ in found.trials} - {frozenset()}
    reason = f"The search was ended after {count_of(len(fitted), 'fit')}"
    if fits.leads:
        reason += f"; {' + '.join(sorted(fits.leads))} leads, and nothing is tested"
    return Diagnosis("undecided", f"{reason}.", model, model, search=found, cannot_tell=cannot_tell)


def _not_possible(base: FittedModel) -> str | None:
    """Return the reason why no diagnosis is possible, or None."""
    fitted = base.fitted
    if not base.problem.runs:
        return "No run lasts beyond its first full slip, before which its history matters."
    if fitted is None:
        return "No parameter of the nominal model is identifiable from these recordings."
    if not fitted.converged:
        return f"The fit of the nominal model did not converge ({fitted.message})."
    return None


def bench_folds(bench: Bench) -> Folds:
    """Return the folds of a bench's runs, in blocks longer than the autocorrelation."""
    return folds_of(blocks_of(bench.closed, bench.rigs))


def _concluded(proven: Proven, base: FittedModel, step: Steps) -> Diagnosis:
    """Return the diagnosis from the effects that prove to be causes."""
    judged, causes, stand_ins = proven.judged, proven.causes, proven.stand_ins
    bench, folds, named = judged.bench, judged.folds, judged.named
    before = judged.trial(frozenset(), on_mesh=bench.on_mesh(named))
    final = judged.trial(named)
    nominal = list(proven.estimates)
    if named:
        nominal = estimates_with_tolerances(judged, before, tolerances(bench, before)).estimates
    errors = proven.held_out[frozenset()].rmse, proven.held_out[named].rmse
    channels = channel_errors(bench, *errors, proven.start, proven.after)
    only_noise = proven.after.complete and not any(map(is_far_off, channels, channels.values()))
    law, whole = None, proven.whole if stand_ins else None
    if not only_noise:
        unproven = None if whole is None else whole.judged.trial(whole.judged.named)
        law = describe(bench, final, predicted_folds(final, folds), step, unproven)
    if law is not None:  # one number of one name: before the law is after the causes
        law = replace(law, before=proven.held_out[named])
    verdict = verdict_of(
        [cause.rivals for cause in causes],
        [cause.effect for cause in stand_ins],
        complete=only_noise and not any(cause.law_differs for cause in causes),
        described=law is not None,
    )
    fault = wandering(proven.after) if verdict == "unexplained" else None
    follows_nothing = verdict == "unexplained" and not proven.after.depends_on
    if fault is None and verdict in ("sufficient", "unexplained"):
        frictions = (
            frictions_of(final, proven.tolerated, folds.run)
            if verdict == "sufficient" or follows_nothing
            else frictions_that_explain(bench, final)
        )
        fault = differing(frictions, [errors.run.run for errors in bench.closed])
        verdict = verdict if fault is None else "unexplained"
    gaining = frozenset[str]() if proven.whole is None else proven.whole.judged.named
    nearest = proven.search.best_alone(gaining)
    reason = reason_of(verdict, causes, stand_ins, channels, proven.after, law, nearest)
    return Diagnosis(
        verdict,
        reason if fault is None else f"{reason} {fault.sentence}.",
        model=Model(proven.estimates if law is None else law.estimates).over(base.model),
        nominal=Model(tuple(nominal)).over(base.model),
        causes=causes,
        stand_ins=stand_ins,
        channels=channels if law is None else with_law(channels, law.after.rmse),
        remainder=proven.after,
        share_left=share_left(proven.start, proven.after),
        search=proven.search,
        judged=judged,
        before=before,
        final=final,
        cannot_tell=(*base.not_identifiable, *travel_notes(proven.estimates, named)),
        stand_in_model=(
            Model(whole.estimates).over(base.model) if whole is not None and law is None else None
        ),
        law=law,
        fault=fault,
    )
