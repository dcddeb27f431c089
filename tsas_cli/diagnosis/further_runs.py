"""Runs that are there, and runs that might be added to them, seen in one look."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np

from tsas_cli.diagnosis.candidates import Candidate, candidates, recorded_limits
from tsas_cli.diagnosis.made_runs import APART, made
from tsas_cli.diagnosis.rig_file import Sensors
from tsas_cli.diagnosis.visibility import Look, Part, look_at
from tsas_cli.identification.extension import Bench, bench_of
from tsas_cli.identification.fit_problem import prepare_fit
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.errors import InputError

SEED = 2  # of the noise of runs that might be added


@dataclass(frozen=True)
class FurtherRuns:
    """A look at runs, and which of them are there already; `left_out` says what shows nothing."""

    look: Look
    there: tuple[int, ...]
    added: dict[int, Candidate]
    left_out: tuple[str, ...]

    def part(self, *added: int) -> Part:
        """Return the runs that are there, and some of those that might be added."""
        return self.look.part([*self.there, *added])


def beside(
    runs: Sequence[Prepared],
    further: Sequence[tuple[Candidate, Prepared]],
    initial: Model,
    fixed: Model,
    free: Mapping[str, float] | None = None,
) -> FurtherRuns:
    """Look at runs and further ones in one fit of the nominal parameters.

    Parameters
    ----------
    runs, further
        The runs that are there, and those that might be added.
    initial, fixed
        The values that the fit begins with, and those of parameters that are not identifiable.
    free
        Parameters of effects that are free in the fit, with their initial values.

    Raises
    ------
    InputError
        Not one of the runs that are there makes the whole tendon slip.
    """
    problem = prepare_fit(initial, fixed, [*runs, *(run for _, run in further)])
    by_id = {run.run.id: candidate for candidate, run in further}
    there = tuple(k for k, run in enumerate(problem.runs) if run.run.id not in by_id)
    if not there:
        raise InputError(
            "no run makes the whole tendon slip, so that nothing can be seen",
            expected="strokes that stretch the tendon and move the load",
            remedy="plan a larger amplitude_mm",
        )
    bench = bench_of(solve_fit(problem))
    named = sorted({name.split(".")[0] for name in free or {}})
    look = look_at(bench, bench.fit(named, free or {}, on_mesh=True))
    added = {k: by_id[r.run.id] for k, r in enumerate(problem.runs) if r.run.id in by_id}
    left_out = tuple(s for s in problem.left_out if not any(i in s for i in by_id))
    return FurtherRuns(look, there, added, left_out)


def beside_recorded(bench: Bench, free: Mapping[str, float] | None = None) -> FurtherRuns:
    """Look at the runs of a bench and at what might be recorded beside them on the same rig."""
    base = bench.base.problem
    plain = [(r.drive_column, r.run.load) == ("x_in_mm", "spring") for r in base.runs]
    further: list[tuple[Candidate, Prepared]] = []
    if any(plain):
        k = plain.index(True)
        first = base.runs[k]
        noise = {name: sd for name, sd in first.noise.items() if sd > 0.0}
        sensors = Sensors(
            rate_Hz=1.0 / float(np.median(np.diff(first.time_s))),
            x_in_mm=first.conditioned["x_in_mm"].noise,
            **noise,
        )
        proposed = candidates(recorded_limits(base.runs), bench.rigs[k])
        further = recorded_in_thought(proposed, sensors, bench.rigs[k], base.runs)
    return beside(base.runs, further, base.initial, base.fixed, free)


def recorded_in_thought(
    proposed: Sequence[Candidate], sensors: Sensors, rig: Rig, runs: Sequence[Prepared]
) -> list[tuple[Candidate, Prepared]]:
    """Return candidates with what they would record, each right after the last run."""

    def rig_of(run: Run) -> Rig:
        return rig._replace(
            sheath_length_mm=run.sheath_length_mm or rig.sheath_length_mm,
            total_bend_rad=rig.total_bend_rad if run.total_bend_rad is None else run.total_bend_rad,
            preload_N=run.preload_N or rig.preload_N,
        )

    started, ends = _clock(runs)
    return [
        (c, prepare(made([c.run], sensors, rig_of, ends, seed=SEED + k)[0], started))
        for k, c in enumerate(proposed)
    ]


def _clock(runs: Sequence[Prepared]) -> tuple[datetime | None, datetime]:
    """Return when the session began, None where the runs do not say, and when it may go on."""
    last = max(runs, key=lambda run: run.session_s)
    if last.run.started is None or last.session_s == 0.0:
        return None, datetime(2000, 1, 1)  # noqa: DTZ001 # the clock of a rig has no zone
    began = last.run.started - timedelta(seconds=last.session_s)
    lasts = timedelta(seconds=float(last.time_s[-1] - last.time_s[0]))
    return began, last.run.started + lasts + APART
