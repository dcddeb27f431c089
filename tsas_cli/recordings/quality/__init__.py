"""Checks of recordings for faults, before a model is fitted."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.pieces import long_run
from tsas_cli.recordings.quality.checks import (
    ac_coupled,
    bursts,
    clipped,
    copies,
    delay,
    exchanged,
    few_reversals,
    filtered,
    gap,
    hum,
    interference,
    lost_samples,
    manifest_unit,
    negative_tension,
    no_steady_motion,
    outlier,
    quantised,
    repeated_buffer,
    repeated_rows,
    repeated_values,
    sign,
    slow_channel,
    stuck,
    time_batches,
    time_jitter,
    time_order,
    unit,
    unknown_key,
    unsteady_sampling,
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

MANIFEST_CHECKS: tuple[QualityCheck[Manifest], ...] = (unknown_key.CHECK, manifest_unit.CHECK)
RUN_CHECKS: tuple[QualityCheck[RunSignals], ...] = (
    time_order.CHECK,
    time_batches.CHECK,
    time_jitter.CHECK,
    unsteady_sampling.CHECK,
    gap.CHECK,
    lost_samples.CHECK,
    outlier.CHECK,
    bursts.CHECK,
    hum.CHECK,
    repeated_rows.CHECK,
    repeated_buffer.CHECK,
    repeated_values.CHECK,
    slow_channel.CHECK,
    filtered.CHECK,
    ac_coupled.CHECK,
    clipped.CHECK,
    stuck.CHECK,
    quantised.CHECK,
    sign.CHECK,
    negative_tension.CHECK,
    exchanged.CHECK,
    interference.CHECK,
    unit.CHECK,
    delay.CHECK,
    few_reversals.CHECK,
    no_steady_motion.CHECK,
)
DATASET_CHECKS: tuple[QualityCheck[Dataset], ...] = (copies.CHECK,)
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
