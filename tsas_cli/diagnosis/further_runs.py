"""Recorded or planned runs together with runs that might be added, in one linearised fit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from tsas_cli.diagnosis.candidates import CandidateRun, candidates, recorded_limits
from tsas_cli.diagnosis.rig_file import Sensors
from tsas_cli.diagnosis.simulated_runs import APART, simulated_recordings
from tsas_cli.diagnosis.visibility import LinearisedRuns, Part, linearised_runs
from tsas_cli.identification.extension import Bench, bench_of
from tsas_cli.identification.fit_problem import prepare_fit
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.errors import InputError

SEED = 2  # of the noise of runs that might be added
OF_A_STROKE = 1000.0  # samples of a proposed run's fastest one, at most: more show nothing more


@dataclass(frozen=True)
class FurtherRuns:
    """A linearised fit of runs, those present (`there`), those proposed (`added`).

    `left_out` has notes on recordings that do not enter the fit.
    """

    look: LinearisedRuns
    there: tuple[int, ...]
    added: dict[int, CandidateRun]
    left_out: tuple[str, ...]

    def part(self, *added: int) -> Part:
        """Return the present runs with some of the proposed ones."""
        return self.look.part([*self.there, *added])


def joined_runs(
    runs: Sequence[Prepared],
    further: Sequence[tuple[CandidateRun, Prepared]],
    initial: Model,
    fixed: Model,
    free: Mapping[str, float] | None = None,
) -> FurtherRuns:
    """Return present and proposed runs in one fit of the nominal parameters.

    `free` are the parameters of effects that are free beside them, with their values;
    `fixed` has the values of parameters that are not identifiable.

    InputError: none of the present runs reaches full slip.
    """
    problem = prepare_fit(initial, fixed, [*runs, *(run for _, run in further)])
    by_id = {run.run.id: candidate for candidate, run in further}
    there = tuple(k for k, run in enumerate(problem.runs) if run.run.id not in by_id)
    if not there:
        raise InputError(
            "no run reaches full slip, so that no effect is visible",
            expected="strokes that stretch the tendon and move the load",
            remedy="plan a larger amplitude_mm",
        )
    look = linearised_runs(bench_of(solve_fit(problem)), free or {})
    added = {k: by_id[r.run.id] for k, r in enumerate(problem.runs) if r.run.id in by_id}
    left_out = tuple(s for s in problem.left_out if not any(i in s for i in by_id))
    return FurtherRuns(look, there, added, left_out)


def joined_to_recorded(bench: Bench, free: Mapping[str, float] | None = None) -> FurtherRuns:
    """Return the runs of a bench with those that might be recorded next on the same rig."""
    base = bench.base.problem
    plain = [(r.drive_column, r.run.load) == ("x_in_mm", "spring") for r in base.runs]
    further: list[tuple[CandidateRun, Prepared]] = []
    if any(plain):
        k = plain.index(True)
        first = base.runs[k]
        noise = {name: sd for name, sd in first.noise.items() if sd > 0.0}
        limits = recorded_limits(base.runs)
        fastest_Hz = 0.5 * (limits.speed_mm_per_s or 1.0) / (limits.amplitude_mm or 1.0)
        recorded_Hz = 1.0 / float(np.median(np.diff(first.time_s)))
        sensors = Sensors(
            rate_Hz=min(recorded_Hz, OF_A_STROKE * fastest_Hz),
            x_in_mm=first.conditioned["x_in_mm"].noise,
            **noise,
        )
        assumed = frozenset(name for name in CONDITIONS if getattr(first.run, name) is None)
        proposed = [replace(c, assumed=assumed) for c in candidates(limits, bench.rigs[k])]
        further = simulated_candidates(proposed, sensors, bench.rigs[k], base.runs)
    return joined_runs(base.runs, further, base.initial, base.fixed, free)


def simulated_candidates(
    proposed: Sequence[CandidateRun], sensors: Sensors, rig: Rig, runs: Sequence[Prepared]
) -> list[tuple[CandidateRun, Prepared]]:
    """Return candidates with simulated recordings, each right after the last run."""

    def rig_of(run: Run) -> Rig:
        return rig._replace(
            sheath_length_mm=run.sheath_length_mm or rig.sheath_length_mm,
            total_bend_rad=rig.total_bend_rad if run.total_bend_rad is None else run.total_bend_rad,
            preload_N=run.preload_N or rig.preload_N,
        )

    started, ends = _clock(runs)
    return [
        (
            c,
            prepare(
                simulated_recordings([c.run], sensors, rig_of, ends, seed=SEED + k)[0], started
            ),
        )
        for k, c in enumerate(proposed)
    ]


def _clock(runs: Sequence[Prepared]) -> tuple[datetime | None, datetime]:
    """Return the start of the session, None where it is unknown, and that of a further run."""
    last = max(runs, key=lambda run: run.session_s)
    if last.run.started is None or last.session_s == 0.0:
        return None, datetime(2000, 1, 1)  # noqa: DTZ001 # the clock of a rig has no zone
    began = last.run.started - timedelta(seconds=last.session_s)
    lasts = timedelta(seconds=float(last.time_s[-1] - last.time_s[0]))
    return began, last.run.started + lasts + APART
