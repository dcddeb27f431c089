"""Checks of recordings for faults, before a model is fitted."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.pieces import long_run
from tsas_cli.recordings.quality.checks import (
    clock,
    extremes,
    motion,
    noise,
    of_dataset,
    pairs,
    rows,
)
from tsas_cli.recordings.quality.finding import (
    CannotTell,
    Finding,
    NotChecked,
    QualityCheck,
    Remark,
)
from tsas_cli.recordings.quality.stretches import look, look_by_stretches
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps

MANIFEST_CHECKS: tuple[QualityCheck[Manifest], ...] = (
    QualityCheck(of_dataset.unknown_key),
    QualityCheck(of_dataset.manifest_unit),
)
RUN_CHECKS: tuple[QualityCheck[RunSignals], ...] = (
    QualityCheck(clock.time_order),
    QualityCheck(clock.time_batches),
    QualityCheck(clock.time_jitter),
    QualityCheck(clock.unsteady_sampling),
    QualityCheck(clock.gap),
    QualityCheck(rows.lost_samples, needs=("x_in_mm",)),
    QualityCheck(noise.outlier),
    QualityCheck(noise.bursts),
    QualityCheck(noise.hum),
    QualityCheck(rows.repeated_rows),
    QualityCheck(rows.repeated_buffer),
    QualityCheck(rows.repeated_values),
    QualityCheck(rows.slow_channel),
    QualityCheck(noise.filtered),
    QualityCheck(extremes.ac_coupled, needs=("x_in_mm",)),
    QualityCheck(extremes.clipped),
    QualityCheck(extremes.stuck),
    QualityCheck(extremes.quantised, of_long="decimated"),
    QualityCheck(motion.sign, needs=("x_in_mm",), of_long="strokes"),
    QualityCheck(motion.negative_tension, of_long="strokes"),
    QualityCheck(motion.exchanged, needs=("x_in_mm", "f_in_N", "f_out_N"), of_long="strokes"),
    QualityCheck(motion.interference, needs=("x_in_mm",)),
    QualityCheck(pairs.unit, of_long="strokes"),
    QualityCheck(pairs.delay, needs=("x_out_mm", "f_out_N")),
    QualityCheck(motion.few_reversals, needs=("x_in_mm",), of_long="decimated"),
    QualityCheck(motion.no_steady_motion, needs=("x_in_mm",), of_long="strokes"),
)
DATASET_CHECKS: tuple[QualityCheck[Dataset], ...] = (QualityCheck(of_dataset.copies),)
CHECKS: tuple[QualityCheck[Any], ...] = (*MANIFEST_CHECKS, *RUN_CHECKS, *DATASET_CHECKS)
CODES = tuple(check.code for check in CHECKS)


@dataclass(frozen=True)
class Report:
    """The findings of the checks, and the checks that did not apply."""

    findings: tuple[Finding, ...]
    not_checked: tuple[NotChecked, ...]


def check_dataset(dataset: Dataset, step: Steps = NO_PROGRESS) -> Report:
    """Return the findings of `check_runs`, and those on the whole dataset.

    InputError: no run can be read.
    """
    of_runs = check_runs(dataset, step)
    of_all = [
        _attributed(result, check.code, result.run)
        for check in DATASET_CHECKS
        for result in check.find(dataset)
    ]
    return _report((*of_runs.findings, *of_runs.not_checked, *of_all))


def check_runs(dataset: Dataset, step: Steps = NO_PROGRESS) -> Report:
    """Return the findings on the manifest and on each run by itself; `step` counts runs.

    An unreadable run is a finding (`unreadable`), as long as another run can be read.

    InputError: no run can be read.
    """
    results = [
        _attributed(result, check.code, None)
        for check in MANIFEST_CHECKS
        for result in check.find(dataset.manifest)
    ]
    failures = []
    step.doing("checks the recordings")
    step.ahead(len(dataset.runs))
    for run in dataset.runs:
        try:
            results += _check_run(dataset, run)
        except InputError as error:
            failures.append(error)
            remedy = "restore the file or ingest again"
            results.append(Finding("unreadable", "error", run.id, None, error.line(), remedy))
        step()
    if len(failures) == len(dataset.runs):
        raise failures[0]
    return _report(results)


def _report(results: Sequence[Finding | NotChecked]) -> Report:
    return Report(
        tuple(r for r in results if isinstance(r, Finding)),
        tuple(r for r in results if isinstance(r, NotChecked)),
    )


def _check_run(dataset: Dataset, run: Run) -> list[Finding | NotChecked]:
    long = long_run(dataset.folder, run)
    if long is not None:
        results = look_by_stretches(RUN_CHECKS, long, dataset.manifest.rig)
    else:
        trial = RunSignals(read_recording(dataset.folder, run, strict=False), dataset.manifest.rig)
        results = {check.code: look(check, trial) for check in RUN_CHECKS}
    return [_attributed(one, code, run.id) for code, each in results.items() for one in each]


def _attributed(result: Remark | CannotTell, code: str, run: str | None) -> Finding | NotChecked:
    if isinstance(result, CannotTell):
        return NotChecked(code, run, result.reason)
    return Finding(
        code, result.severity, run, result.column, result.sentence, result.remedy, result.first_s
    )
