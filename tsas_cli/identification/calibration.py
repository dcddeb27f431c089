"""Calibrate the nominal model on a dataset: phases, stiffness per phase, joint fit."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.against_data_sheet import contradictions
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.comparison import Compared, compare, refuse_invalid
from tsas_cli.identification.dynamic_fit import dynamic_fit
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.joint_fit import misfit, solve_fit
from tsas_cli.identification.long_runs import thinned_notes
from tsas_cli.identification.missing_effects import widened
from tsas_cli.identification.model import CORRECTION, Model, data_sheet
from tsas_cli.identification.phases import Segment, segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.transfer import Slope, tension_transfer, without_transfer
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.wording import listed, some_of

MISSING_EFFECTS_NOTE = (
    "The intervals do not include effects that the model lacks: find them with `tsas diagnose` and "
    "start from its extended model with --model."
)


@dataclass(frozen=True)
class Calibration:
    """The calibrated model with phases, slopes, predictions and notes; lists are per run."""

    model: Model
    runs: Sequence[Prepared]
    segments: Sequence[list[Segment]]
    slopes: Sequence[list[Slope]]
    predictions: Sequence[Compared]
    expected: Sequence[list[Slope]]
    transfer: Sequence[Estimate]
    cannot_tell: Sequence[str]
    fitted: Fitted | None


def calibrate_runs(
    manifest: Manifest,
    runs: Sequence[Prepared],
    step: Steps = NO_PROGRESS,
    *,
    dynamics: Dynamics = "slip",
    stated: Model | None = None,
) -> Calibration:
    """Return the calibrated nominal model; `step` reports each run's phases and each fit.

    A run without f_in_N has no slopes; where no parameter is identifiable, the model is that of the
    data sheet and `cannot_tell` has the reasons. With the dynamic model (`lugre`) its bristles and
    friction over speed are calibrated too. `stated` is the initial model, whose effects are fixed;
    by default the data sheet's.
    """
    stated = stated or data_sheet(manifest)
    for run in runs if dynamics == "lugre" else ():
        refuse_invalid(run.run, stated, run.drive_column, dynamics)
    step.ahead(len(runs) + 1)
    segments, measured = [], []
    for run in runs:
        segments.append(segment(run))
        measured.append(slopes_of(run, segments[-1]))
        step()
    fit = solve_fit(base_fit(stated, runs, segments, measured))
    model, fitted, sentences = fit.model, fit.fitted, fit.cannot_tell
    step()
    dynamic = None
    if dynamics == "lugre" and fitted is not None:
        dynamic = dynamic_fit(model, fit.problem.runs, step)
        model, fitted = dynamic.model, dynamic.fitted
    predictions = [compare(run, model, dynamics) for run in runs]
    expected = [
        slopes_of(run, parts, predicted.response.f_in_N)
        for run, parts, predicted in zip(runs, segments, predictions, strict=True)
    ]
    if dynamic is not None:
        of_runs = [note for predicted in predictions for note in predicted.summary.notes]
        residual_notes = [*dynamic.misfit, MISSING_EFFECTS_NOTE] if dynamic.misfit else []
        sentences = [*dynamic.cannot_tell, *dict.fromkeys(of_runs)]
    else:
        residual_notes = misfit(fit)
        if residual_notes and fitted is not None:
            wider = widened(fit, step)
            model = Model(wider.estimates).over(model)
            residual_notes.append(
                "The intervals are widened by what is not in the model: "
                f"{listed(some_of(wider.effects), ' or ')} would explain most of the residual."
                if wider.effects
                else "No catalogued effect explains the residual: the intervals may not contain "
                "the true values."
            )
    transfer = tension_transfer(runs, segments)
    notes = [
        *contradictions(manifest, model),
        *thinned_notes(runs),
        *residual_notes,
        *unknown_conditions(runs),
        *without_transfer(runs, transfer),
        *sentences,
    ]
    return Calibration(
        with_preload_correction(model, runs),
        runs,
        segments,
        measured,
        predictions,
        expected,
        transfer,
        notes,
        fitted,
    )


def unknown_conditions(runs: Sequence[Prepared]) -> Iterator[str]:
    """Yield a sentence for each condition that the manifest does not state."""
    alike = "; the runs are taken to have the same {}" if len(runs) > 1 else ""
    if any(r.run.total_bend_rad is None for r in runs):
        yield (
            "total_bend_rad is not in the manifest: with an assumed 1 rad friction_coefficient is "
            f"the product of friction and bend{alike.format('bend')}."
        )
    if any(r.run.sheath_length_mm is None for r in runs):
        yield (
            "sheath_length_mm is not in the manifest: with an assumed 1000 mm tendon_stiffness_N "
            f"is the stiffness of one metre{alike.format('length')}."
        )


def with_preload_correction(model: Model, runs: Sequence[Prepared]) -> Model:
    """Return a model with the mean difference of fitted and stated preload.

    Its interval is a prediction interval for a further run; it needs two runs.
    """
    from scipy.special import stdtrit

    fitted = {e.run: e.value for e in model.estimates if e.name == "preload_N" and e.stderr}
    differences = [
        fitted[r.run.id] - r.run.preload_N
        for r in runs
        if r.run.id in fitted and r.run.preload_N is not None
    ]
    count = len(differences)
    if count < 2:
        return model
    mean = float(np.mean(differences))
    spread = float(np.std(differences, ddof=1)) * (1.0 + 1.0 / count) ** 0.5
    half = float(stdtrit(count - 1, 0.975)) * spread
    correction = Estimate(
        CORRECTION,
        mean,
        "N",
        "fitted",
        stderr=spread,
        interval_low=mean - half,
        interval_high=mean + half,
    )
    return Model((correction,)).over(model)
