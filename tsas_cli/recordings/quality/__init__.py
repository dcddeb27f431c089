"""Checks of recordings for faults, before a model is fitted.

A recording that is too long for memory is checked stretch by stretch. Noise, quantisation, span and
extremes are those of the whole run. A stretch is checked with all its rows; a finding states the
number of stretches with it. Properties of the motion (signs, units, exchanged sensors, steady
motion) are checked on the run decimated to the rows of one stretch, as long as a decimated stroke
of the drive has more rows than a stretch has strokes.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.recordings import pieces as reading
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Manifest, RigSheet
from tsas_cli.recordings.pieces import long_run, pieces
from tsas_cli.recordings.quality.checks import (
    bursts,
    clipping,
    clock,
    delay,
    extremes,
    filtering,
    motion,
    noise,
    of_dataset,
    pairs,
    repeats,
    rows,
    signs,
    stick_slip,
)
from tsas_cli.recordings.quality.finding import Finding, NotChecked, QualityCheck
from tsas_cli.recordings.quality.samples import Size, span_of, step_of
from tsas_cli.recordings.quality.trial import FEWEST, RunSignals
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import RunColumns, read_recording
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps

MANIFEST_CHECKS: tuple[QualityCheck[Manifest], ...] = (
    QualityCheck(of_dataset.unknown_key),
    QualityCheck(of_dataset.manifest_unit),
)
RUN_CHECKS: tuple[QualityCheck[RunSignals], ...] = (
    QualityCheck(clock.time_order),
    QualityCheck(clock.time_batches),
    QualityCheck(clock.time_jitter, given=("increases", "unbatched")),
    QualityCheck(clock.unsteady_sampling, given=("increases",)),
    QualityCheck(clock.gap),
    QualityCheck(rows.lost_samples, needs=("x_in_mm",), given=("increases", "strokes")),
    QualityCheck(noise.outlier),
    QualityCheck(rows.jump),
    QualityCheck(bursts.bursts),
    QualityCheck(noise.hum, given=("increases",)),
    QualityCheck(rows.repeated_rows),
    QualityCheck(repeats.repeated_buffer),
    QualityCheck(repeats.repeated_values),
    QualityCheck(repeats.slow_channel),
    QualityCheck(filtering.filtered, given=("increases", "strokes")),
    QualityCheck(extremes.ac_coupled, needs=("x_in_mm",), given=("strokes",)),
    QualityCheck(clipping.clipped),
    QualityCheck(extremes.stuck),
    QualityCheck(extremes.quantised, of_long="decimated"),
    QualityCheck(signs.sign, needs=("x_in_mm",), of_long="strokes"),
    QualityCheck(signs.negative_tension, of_long="strokes"),
    QualityCheck(signs.exchanged, needs=("x_in_mm", "f_in_N", "f_out_N"), of_long="strokes"),
    QualityCheck(
        motion.interference, needs=("x_in_mm",), given=("on_spring", "increases", "unbatched")
    ),
    QualityCheck(
        stick_slip.stick_slip, needs=("x_in_mm", "f_in_N"), given=("increases",), of_long="strokes"
    ),
    QualityCheck(pairs.unit, of_long="strokes"),
    QualityCheck(pairs.duplicate_channel),
    QualityCheck(delay.delay, needs=("x_out_mm", "f_out_N"), given=("on_spring", "increases")),
    QualityCheck(motion.few_reversals, needs=("x_in_mm",), of_long="decimated"),
    QualityCheck(
        motion.no_steady_motion, needs=("x_in_mm",), given=("strokes",), of_long="strokes"
    ),
)
DATASET_CHECKS: tuple[QualityCheck[Dataset], ...] = (QualityCheck(of_dataset.copies),)
CHECKS: tuple[QualityCheck[Any], ...] = (*MANIFEST_CHECKS, *RUN_CHECKS, *DATASET_CHECKS)
CODES = tuple(check.code for check in CHECKS)
Results = list[Finding | NotChecked]
# Warnings that make results wrong where most runs have them; in one run they may be the motion's.
IN_MOST_RUNS = ("filtered", "repeated-values", "slow-channel", "hum")


@dataclass(frozen=True)
class Report:
    """The findings of the checks, and the checks that did not apply."""

    findings: tuple[Finding, ...]
    not_checked: tuple[NotChecked, ...]

    @classmethod
    def of(cls, results: Sequence[Finding | NotChecked]) -> Self:
        """Return results, sorted by kind."""
        return cls(
            tuple(r for r in results if isinstance(r, Finding)),
            tuple(r for r in results if isinstance(r, NotChecked)),
        )


def check_dataset(dataset: Dataset, step: Steps = NO_PROGRESS) -> Report:
    """Return the findings of `check_runs`, and those on the whole dataset.

    InputError: no run can be read.
    """
    of_runs = check_runs(dataset, step)
    of_all = [one for check in DATASET_CHECKS for one in check.results(dataset)]
    return Report.of((*of_runs.findings, *of_runs.not_checked, *of_all))


def check_runs(dataset: Dataset, step: Steps = NO_PROGRESS) -> Report:
    """Return the findings on the manifest and on each run by itself; `step` counts runs.

    An unreadable run is a finding (`unreadable`), as long as another run can be read.

    InputError: no run can be read.
    """
    results = [one for check in MANIFEST_CHECKS for one in check.results(dataset.manifest)]
    failures = []
    step.doing("checks the recordings")
    step.ahead(len(dataset.runs))
    for run in dataset.runs:
        try:
            if (long := long_run(dataset.folder, run)) is not None:
                found = look_by_stretches(RUN_CHECKS, long, dataset.manifest.rig)
            else:
                recording = read_recording(dataset.folder, run, strict=False)
                trial = RunSignals(recording, dataset.manifest.rig)
                found = [one for check in RUN_CHECKS for one in look(check, trial)]
            results += [replace(one, run=run.id) for one in found]
        except InputError as error:
            failures.append(error)
            said = error.line(), "restore the file or ingest again"
            results.append(Finding("error", None, *said, code="unreadable", run=run.id))
        step()
    if len(failures) == len(dataset.runs):
        raise failures[0]
    return Report.of(_weighed(results, len(dataset.runs)))


def _weighed(results: Results, runs: int) -> Results:
    """Return the results, warnings of `IN_MOST_RUNS` as errors where most of the runs have them."""
    having: dict[tuple[str, str | None], set[str | None]] = {}
    for one in results:
        if isinstance(one, Finding) and one.code in IN_MOST_RUNS:
            having.setdefault((one.code, one.column), set()).add(one.run)
    most = {which for which, of in having.items() if 2 * len(of) > runs}
    return [
        replace(one, severity="error")
        if isinstance(one, Finding) and (one.code, one.column) in most
        else one
        for one in results
    ]


GIVEN = {  # properties of `RunSignals`, and what is said where they do not hold
    "on_spring": "the load is no spring",
    "increases": "time does not increase",
    "unbatched": "rows come in batches",
    "strokes": "the drive does not move visibly",
}
_NUMBER = r"-?\d[\d.,e+-]*( \w+)?"
OVERLAP = 16  # consecutive stretches share one in so many of their rows


def look(check: QualityCheck[RunSignals], trial: RunSignals) -> Results:
    """Return the results of a check on a trial, or the reason why it does not apply."""
    with np.errstate(all="ignore"):  # a stray 1e300 may overflow
        missing = [name for name in check.needs if name not in trial.channels]
        if missing:
            absent = [name for name in missing if name not in trial.recording.columns]
            why = "not recorded" if absent else f"with fewer than {FEWEST} valid samples"
            return [NotChecked(f"{' and '.join(absent or missing)} {why}", code=check.code)]
        for name in check.given:
            if not getattr(trial, name):
                return [NotChecked(GIVEN[name], code=check.code)]
        return list(check.results(trial))


def look_by_stretches(
    checks: Sequence[QualityCheck[RunSignals]], run: RunColumns, rig: RigSheet
) -> Results:
    """Return the results of the checks on a long run."""
    overall, decimated = _overview(run)
    whole = RunSignals(Recording(run.run, decimated), rig, overall)
    # A decimated stroke has to have more rows than a stretch has strokes.
    shown = len(whole.strokes) ** 2 <= whole.time_s.size * run.rows / reading.MOST_ROWS
    decimatable = {"decimated", "strokes"} if shown else {"decimated"}
    results: dict[str, list[tuple[str, Results]]] = {
        check.code: [] for check in checks if check.of_long not in decimatable
    }
    overlap = reading.MOST_ROWS // OVERLAP
    for piece in pieces(run, run.known, overlap=overlap, strict=False):
        trial = RunSignals(Recording(run.run, piece.columns), rig, overall, piece.start)
        there = f"rows {piece.start} to {piece.stop - 1}"
        for check in checks:
            if check.code in results:
                results[check.code].append((there, look(check, trial)))
    found = [
        _merged(results[check.code]) if check.code in results else look(check, whole)
        for check in checks
    ]
    return [one for of_check in found for one in of_check]


def _merged(stretches: Sequence[tuple[str, Results]]) -> Results:
    """Return the results of a check on a run, from those on its stretches.

    Of findings that differ in numbers only, the first one stays, with the number of stretches.
    """
    found: dict[str, list[tuple[str, Finding]]] = {}
    for where, results in stretches:
        for one in results:
            if isinstance(one, Finding):
                same = f"{one.column} {re.sub(_NUMBER, '', one.sentence)}"
                found.setdefault(same, []).append((where, one))
    each = [results for _, results in stretches]
    if not found:  # a check that applies to one stretch applies
        return list(each[0]) if all(each) else []
    count = len(stretches)
    not_checked = (one for one in each[0] if isinstance(one, NotChecked))
    return [one for one in not_checked if all(one in results for results in each)] + [
        replace(
            first,
            sentence=f"{first.sentence} ({where}; in {len(dict(same))} of {count} stretches of the "
            "run)",
        )
        for same in found.values()
        for where, first in same[:1]
    ]


def _overview(run: RunColumns) -> tuple[dict[str, Size], dict[str, Floats]]:
    """Return the properties of the whole run, and its columns decimated to the rows of a piece."""
    every = -(-run.rows // reading.MOST_ROWS)
    decimated: dict[str, list[Floats]] = {name: [] for name in run.known}
    seen: dict[str, list[tuple[Floats, float, float, float]]] = {}
    for piece in pieces(run, run.known, strict=False):
        for name, values in piece.columns.items():
            decimated[name].append(values[-piece.start % every :: every].copy())
            finite = values[np.isfinite(values)]
            if finite.size and name != TIME:
                ends = float(finite.min()), float(finite.max())
                noise = noise_sd(values, piece.columns[TIME])
                part = finite[::every].copy(), noise, *ends
                seen.setdefault(name, []).append(part)
    overall = {}
    for name, parts in seen.items():
        valid, noises, lowest, highest = zip(*parts, strict=True)
        each, known = np.concatenate(valid), [sd for sd in noises if not math.isnan(sd)]
        middle = float(np.median(known)) if known else math.nan
        overall[name] = Size(middle, step_of(each), span_of(each), min(lowest), max(highest))
    return overall, {name: np.concatenate(parts) for name, parts in decimated.items()}
