"""The diagnose stage: `diagnosis.json`, both models, and what each predicts of the runs."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tsas_cli.diagnosis import found
from tsas_cli.diagnosis.diagnose import Diagnosis, diagnose_runs
from tsas_cli.diagnosis.faults.words import CODES
from tsas_cli.diagnosis.law_words import records_of
from tsas_cli.diagnosis.next_experiment import next_experiment
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.identification.against_data_sheet import contradictions
from tsas_cli.identification.calibration import unknown_conditions
from tsas_cli.identification.comparison import compare
from tsas_cli.identification.fitted_to import FittedTo, fitted_to
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import source_of, stated_model, write_model
from tsas_cli.identification.phases import segment, segment_records
from tsas_cli.identification.prepared import Prepared
from tsas_cli.recordings.columns import BY_NAME, nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.deduplicated import without_duplicates
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.writing import write_result
from tsas_cli.records import diagnosis as records
from tsas_cli.records.base import number_text
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.before_fit import errors_and_warnings, prepared_runs
from tsas_cli.stages.given import Named, dataset_of, listed, path_of
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHOWN = 8  # hypotheses that are printed


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisResult(Result):
    """A verdict on what the nominal model lacks, and the extended model."""

    record: records.DiagnosisFile  # what `diagnosis.json` holds
    diagnosis: Diagnosis  # all that the verdict rests on

    @property
    def verdict(self) -> records.Verdict:
        """`named`, `ambiguous`, `partly`, `described`, `stand_in` … (`records.Verdict`)."""
        return self.diagnosis.verdict

    @property
    def reason(self) -> str:
        """The verdict in one plain sentence."""
        return self.diagnosis.reason

    @property
    def causes(self) -> tuple[FoundCause, ...]:
        """What is named, with rivals, parameters and the gain on held-out data [%]."""
        return self.diagnosis.causes

    @property
    def model(self) -> Model:
        """The extended model; where nothing is named the nominal one, fitted again."""
        return self.diagnosis.model

    @property
    def next_experiment(self) -> str:
        """What to measure next."""
        return self.record.next_experiment

    def plot(self, run: str | None = None, channel: str = "f_in_N") -> "tuple[Axes, Axes]":
        """Draw a run (the first one without it) with both models and their residuals.

        With matplotlib's pyplot; returns the axes of the loop and of the residual.

        Raises
        ------
        InputError
            Nothing was fitted, or there is no such run or channel.
        """
        judged = self.diagnosis.judged
        if judged is None:
            raise InputError("nothing was fitted, so that there is nothing to draw")
        runs = {errors.run.run.id: errors.run for errors in judged.bench.closed}
        chosen = next(iter(runs)) if run is None else run
        if chosen not in runs:
            raise InputError(f"no run {chosen}", remedy=nearest(chosen, list(runs)))
        models = {"nominal model": self.diagnosis.nominal}
        if self.record.extended:
            models["extended model"] = self.model
        return _plot_loop(runs[chosen], models, channel)

    def tables(self) -> Iterator[Table]:
        """Yield what is named or not proven, the errors before and after, and the ranking."""
        columns = ("effect", "parameter", "value [95 %]", "unit", "rivals")
        for heading, causes in (
            (self.titled("causes", records.EXTENDED_MODEL), self.record.named),
            ("gains, but is not proven", self.record.stand_ins),
        ):
            rows = [
                (c.effect, name, v.text(), v.unit, ", ".join(c.rivals))
                for c in causes
                for name, v in c.parameters.items()
            ]
            if causes:
                yield heading, columns, rows
        if self.record.channels:
            yield records.errors_table(self.record.channels)
        ranking = [
            (
                " + ".join(row.effects),
                number_text(row.gain_percent, ".1f"),
                number_text(row.test_statistic, ".1f"),
                "" if row.converged else "not converged",
            )
            for row in self.record.candidates[:SHOWN]
        ]
        if ranking:
            of = f", best {len(ranking)} of {len(self.record.candidates)}"
            yield f"hypotheses{of}", ("effects", "reduction [%]", "test statistic", ""), ranking

    def sentences(self) -> list[str]:
        """Return the verdict, what to measure next, and what the recordings do not say."""
        slow = self.record.remainder.slow_noise
        return [
            f"{records.VERDICTS[self.verdict]} (verdict: {self.verdict}). {self.reason}",
            *(law.sentence for law in self.record.laws),
            *(noise.text(name) for name, noise in slow.items()),
            f"Next: {self.next_experiment}",
            *notes([*self.record.accepted(), *self.record.warned(), *self.record.cannot_tell]),
        ]


def diagnose(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    runs: Iterable[str] | None = None,
    despite: str | Iterable[str] = (),
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> DiagnosisResult:
    """Show what the simulation gets wrong, name the cause, extend the model, measure the gain.

    Parameters
    ----------
    dataset
        A dataset, or its folder.
    out
        Where to write `diagnosis.json` and `model-extended.toml`; None writes nothing.
    model
        A model to begin with, or its file; the data sheet's without it.
    runs
        The ids of the runs that are taken; all without it.
    despite
        Codes of checks whose errors are accepted (`tsas.check`); any other error stops it. The
        codes of faults of single runs too, which are not sought then.
    force
        Replace the folder if it is there.
    step
        Called for every hypothesis; the number of them grows with the findings.

    Returns
    -------
    DiagnosisResult
        `.verdict`, `.reason`, `.causes` (effect, rivals, parameters with 95 % intervals, gain on
        held-out data [%]), `.model` (the extended one), `.next_experiment`; `.summary` is what
        `diagnosis.json` holds, with the errors before and after, in each channel's unit.

    Raises
    ------
    InputError
        A recording or the model is wrong, the checks find an error, or `out` exists and
        `force` is not set.
    """
    data, known, path = dataset_of(dataset, runs), path_of(model, Model), path_of(out)
    stated, accepted = stated_model(data.manifest, known), listed(despite)
    not_sought = tuple(code for code in accepted if code in CODES)
    with folder_if(path, stage="diagnose", inputs=[data.folder, known], force=force) as folder:
        checked = errors_and_warnings(data, accepted, step, further=CODES)
        counted = without_duplicates(data)
        step.doing("cleans the runs")
        step.ahead(len(counted.dataset.runs) + 1)
        prepared = prepared_runs(counted, step)
        result = diagnose_runs(data.manifest, stated, prepared, step, accepted=accepted)
        record = records.DiagnosisFile(
            **counted.dataset.header(path),
            **checked,
            model=source_of(known, path),
            verdict=result.verdict,
            reason=result.reason,
            named=[found.cause_of(cause) for cause in result.causes],
            stand_ins=[found.cause_of(cause) for cause in result.stand_ins],
            laws=() if result.law is None else records_of(result.law),
            faults=() if result.fault is None else (result.fault,),
            channels=found.held_out_of(result),
            remainder=found.remainder_of(result),
            next_experiment=next_experiment(result, step),
            candidates=found.candidates_of(result),
            signatures=found.signatures_of(result.search),
            residual_map=found.residual_maps_of(result),
            evidence=found.evidence_of(result),
            cannot_tell=(
                *(
                    f"The diagnosis does not seek the fault {code} of the recordings (--despite)."
                    for code in not_sought
                ),
                *counted.notes,
                *found.beside_a_law(result),
                *unknown_conditions(prepared),
                *contradictions(data.manifest, result.model, [c.effect for c in result.causes]),
                *result.cannot_tell,
            ),
            not_sought=not_sought,
            solver="" if result.final is None else result.final.solver,
            segments={run.run.id: segment_records(run, segment(run)) for run in prepared},
        )
        step()
        if folder is not None:
            _write(folder, record, result, prepared, fitted_to(data.manifest.rig, prepared))
    return DiagnosisResult(record.content(), path, record, result)


def _write(
    folder: Path,
    record: records.DiagnosisFile,
    result: Diagnosis,
    runs: Sequence[Prepared],
    ranges: FittedTo,
) -> None:
    record.write(folder)
    fitted = record.source().content()
    for name, model in (
        (records.EXTENDED_MODEL, result.model),
        (records.NOMINAL_MODEL, result.nominal),
        (records.STAND_IN_MODEL, result.stand_in_model),
    ):
        if model is not None:
            path = folder / name
            write_model(path, model, version=record.version, dataset=fitted, fitted_to=ranges)
    (folder / "runs").mkdir()
    for run in runs:
        write_result(folder / "runs", _predictions(run, result.model, result.nominal))


def _predictions(run: Prepared, extended: Model, nominal: Model) -> Recording:
    """Return time, the conditioned or simulated x_in, and what each model predicts."""
    after, before = compare(run, extended), compare(run, nominal)
    columns = {"time_s": run.time_s, "x_in_mm": after.response.x_in_mm, **after.channels}
    columns |= {nominal_name(name): values for name, values in before.channels.items()}
    return Recording(run.run, columns)


def _plot_loop(run: Prepared, models: Mapping[str, Model], channel: str) -> "tuple[Axes, Axes]":
    """Draw a channel over x_in, and the residual of each model below; return the two axes.

    InputError: the run has no such channel.
    """
    from matplotlib import pyplot as plt

    from tsas_cli.reporting.colours import schemes

    measured = run.measured.get(channel)
    if measured is None:
        remedy = nearest(channel, list(run.measured))
        raise InputError(f"run {run.run.id} has no measured {channel}", remedy=remedy)
    light, _ = schemes()
    figure, (loop, below) = plt.subplots(2, sharex=True, height_ratios=(3, 1), layout="constrained")
    style: dict[str, Any] = {"linewidth": 1.0}
    for number, (name, model) in enumerate(models.items()):
        found = compare(run, model)
        x_in = found.response.x_in_mm
        if number == 0:
            loop.plot(x_in, measured, label="measured", color=light["measured"], **style)
        colour = light[("before", "after")[number]]
        loop.plot(x_in, found.channels[channel], label=name, color=colour, **style)
        below.plot(x_in, measured - found.channels[channel], color=colour, **style)
    unit = BY_NAME[channel].unit
    short = channel.rpartition("_")[0]
    loop.set(title=f"Run {run.run.id}", ylabel=f"{short} [{unit}]")
    below.set(xlabel="x_in [mm]", ylabel=f"residual [{unit}]")
    loop.legend()
    figure.align_ylabels()
    return loop, below
