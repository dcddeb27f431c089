"""Visibility of effects in a set of planned runs, and the most informative further run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from itertools import combinations

from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility
from tsas_cli.diagnosis.candidates import CandidateRun, candidates, planned_limits, within
from tsas_cli.diagnosis.evidence import CRITICAL_VALUE
from tsas_cli.diagnosis.further_runs import (
    FurtherRuns,
    joined_runs,
    joined_to_recorded,
    simulated_candidates,
)
from tsas_cli.diagnosis.rig_file import RigFile
from tsas_cli.diagnosis.simulated_runs import simulated_recordings
from tsas_cli.effects import EFFECTS, Effect
from tsas_cli.identification.base_fit import base_fit, slopes_of
from tsas_cli.identification.extension import Bench, bench_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import prepare
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.quality.copies.deduplicated import DeduplicatedDataset
from tsas_cli.support.steps import NO_PROGRESS, Steps

PROPOSED = 3
LEAST_FACTOR = 1.2  # by which a size has to fall
FIRST = datetime(2000, 1, 1)  # noqa: DTZ001 # start of simulated runs; a rig has no time zone


@dataclass(frozen=True)
class Better:
    """The smallest size at which a cause is named, without and with a further run."""

    cause: Amplitude
    before: float
    after: float


@dataclass(frozen=True)
class FurtherRun:
    """A further run, and its improvements, the largest first.

    `score` is the mean decrease of the logarithm of the smallest named sizes, `groups` are the
    pairs of effects that remain indistinguishable.
    """

    candidate: CandidateRun
    score: float
    better: tuple[Better, ...]
    groups: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ExperimentPlan:
    """Visibility of effects in planned runs.

    `groups` are pairs of indistinguishable effects, `cannot_tell` has sentences on what the runs do
    not determine, and why.
    """

    seen: tuple[Visibility, ...]
    groups: tuple[tuple[str, str], ...]
    proposals: tuple[FurtherRun, ...]
    cannot_tell: tuple[str, ...]


def plan_rig(file: RigFile, step: Steps = NO_PROGRESS) -> ExperimentPlan:
    """Return the plan for the runs of a rig file.

    InputError: none of the runs reaches full slip, or one is too long.
    """
    step.ahead(1)
    # A manifest needs a run; only its rig is used here.
    nobody = Run(id="none", file="none", sha256="0" * 64)
    sheet = Manifest(format=1, name=file.name, kind="simulated", rig=file.rig, run=(nobody,))
    model = data_sheet(sheet)
    runs = [
        prepare(r, FIRST) for r in simulated_recordings(file.run, file.sensors, model.rig, FIRST)
    ]
    usual = model.rig(runs[0].run)
    proposed = candidates(within(file.limits, planned_limits(file.run)), usual, file.run[0])
    further = simulated_candidates(proposed, file.sensors, usual, runs)
    return _plan(joined_runs(runs, further, model, model), step)


def plan_dataset(counted: DeduplicatedDataset, step: Steps = NO_PROGRESS) -> ExperimentPlan:
    """Return the plan for the runs of a dataset, without duplicate samples.

    InputError: a recording is invalid, or none reaches full slip.
    """
    step.ahead(1)
    manifest = counted.dataset.manifest
    runs = [
        prepare(recording, manifest.session_start, counted.copied_of(recording.run.id))
        for recording in counted.dataset
    ]
    segments = [segment(run) for run in runs]
    measured = [slopes_of(run, parts) for run, parts in zip(runs, segments, strict=True)]
    base = solve_fit(base_fit(data_sheet(manifest), runs, segments, measured))
    plan = _plan(joined_to_recorded(bench_of(base)), step)
    return replace(plan, cannot_tell=(*counted.notes, *plan.cannot_tell))


def propose(
    bench: Bench, trial: HypothesisFit, effects: Sequence[str], step: Steps = NO_PROGRESS
) -> CandidateRun | None:
    """Return the further run that distinguishes several effects best, None where none does.

    Other effects of the trial stay free.
    """
    step.doing("looks for the next experiment")
    step.ahead(1)
    rivals = [e for e in EFFECTS if e.name in effects]
    free = {name: v for name, v in trial.values().items() if name.split(".")[0] not in effects}
    runs = joined_to_recorded(bench, free)
    step()
    step.ahead(len(runs.added))
    found = _proposals(runs, runs.part().seen(rivals, rivals), rivals, step)
    return next((p.candidate for p in found if p.better and not p.groups), None)


def _plan(runs: FurtherRuns, step: Steps) -> ExperimentPlan:
    step()
    step.ahead(1 + len(runs.added))
    seen = runs.part().seen(EFFECTS, EFFECTS)
    step()
    proposals = _proposals(runs, seen, EFFECTS, step)
    cannot_tell = [*runs.left_out, *_few(runs.part().blocks)]
    return ExperimentPlan(
        tuple(seen), _groups(seen), tuple(proposals[:PROPOSED]), tuple(cannot_tell)
    )


def _few(blocks: int) -> list[str]:
    """Return a note if the blocks are too few: the test statistic is at most √blocks."""
    least = math.floor(CRITICAL_VALUE**2) + 1
    sentence = f"These runs have {blocks} independent stretches; a diagnosis needs at least {least}"
    return [f"{sentence}."] if blocks < least else []


def _proposals(
    runs: FurtherRuns, seen: Sequence[Visibility], rivals: Sequence[Effect], step: Steps
) -> list[FurtherRun]:
    """Return the further runs with an improvement, the best first."""
    effects = list({s.cause.effect.name: s.cause.effect for s in seen}.values())
    out = []
    for k, candidate in runs.added.items():
        out.append(_proposal(candidate, seen, runs.part(k).seen(effects, rivals)))
        step()
    return sorted((p for p in out if p.score > 0.0), key=lambda p: -p.score)


def _proposal(
    candidate: CandidateRun, before: Sequence[Visibility], after: Sequence[Visibility]
) -> FurtherRun:
    falls, improved = {}, []
    for b, a in zip(before, after, strict=True):
        largest = b.cause.largest
        falls[b.cause.name] = math.log(min(b.counted, largest) / min(a.counted, largest))
        if b.counted > LEAST_FACTOR * a.counted:
            improved.append(Better(b.cause, b.named, a.named))
    improved.sort(key=lambda pair: -falls[pair.cause.name])
    return FurtherRun(candidate, sum(falls.values()) / len(falls), tuple(improved), _groups(after))


def _groups(seen: Sequence[Visibility]) -> tuple[tuple[str, str], ...]:
    """Return the pairs of indistinguishable effects."""
    hidden = {(s.cause.effect.name, rival) for s in seen for rival in s.hidden_in}
    pairs = combinations([e.name for e in EFFECTS], 2)
    return tuple(pair for pair in pairs if pair in hidden and pair[::-1] in hidden)
