"""A run followed along the tendon, with one model or with two at the same moments."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.model import Model
from tsas_cli.physics.compliances import compliance_at_drive, sheath_compliance
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.passages import Passage, passages, turns
from tsas_cli.physics.response import Dynamics, Prediction, simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.manifest import Run
from tsas_cli.reporting.stream.recorder import Times, times_of
from tsas_cli.reporting.stream.sources import Which

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

PER_SECOND = 15.0
PER_SPAN = 120.0  # while a tension goes through all that it has in the run: half a dead band of
#   the source paper's rig then takes about thirty
MOST = 1500  # of one run, whatever its length, and as many turns


@dataclass(frozen=True)
class TendonStates:
    """What one model says along the tendon of a run, at k moments of its n samples.

    `started` is when the run began, None where that is not known. `sample_time_s`, shape (n,), is
    the recording's own time; `passages` are of all samples.
    """

    rig: Rig
    started: datetime | None
    sample_time_s: Floats
    response: Prediction
    frames: Frames
    passages: list[Passage]

    @property
    def time_s(self) -> Floats:
        """Time of the moments, shape (k,)."""
        times: Floats = self.sample_time_s[self.frames.samples]
        return times

    @property
    def times(self) -> Times:
        """The moments on the viewer's timelines."""
        return self.at(self.time_s)

    def at(self, time_s: Floats) -> Times:
        """Return other moments of the run [s] on the viewer's timelines."""
        return times_of(time_s, self.started)

    @property
    def x_in_mm(self) -> Floats:
        """Displacement of the drive from the state of uniform preload, shape (k,)."""
        shown: Floats = self.response.x_in_mm[self.frames.samples] - self.rig.x_in_zero_mm
        return shown

    @property
    def x_out_mm(self) -> Floats:
        """Displacement of the load from there, shape (k,)."""
        shown: Floats = self.response.x_out_mm[self.frames.samples] - self.rig.x_out_zero_mm
        return shown

    @property
    def slips(self) -> npt.NDArray[np.bool_]:
        """Whether each element slips, shape (k, m)."""
        return np.isin(self.frames.slip, (1, -1))

    @property
    def front_runs_now(self) -> npt.NDArray[np.bool_]:
        """Whether a front is on its way from the drive to the load, shape (k,)."""
        return (self.frames.front > 0.0) & (self.frames.front < 1.0)

    def tension_at_front(self) -> Floats:
        """Return the tension where the front is, shape (k,) [N]."""
        frames = self.frames
        rows = zip(frames.front, np.nan_to_num(frames.tension_N), strict=True)
        return np.array([np.interp(front, frames.places, row) for front, row in rows])

    def turned(self) -> Indices:
        """Return for each moment the sample at which the drive has turned last, shape (k,)."""
        starts = np.array([0, *(run.start for run in self.passages)])
        last: Indices = starts[np.searchsorted(starts, self.frames.samples, side="right") - 1]
        return last

    def moved_mm(self) -> Floats:
        """Return how far each place has moved towards the drive, shape (k, m + 1) [mm].

        It is the drive's way less the stretch of the tendon in between (Hooke's law).
        """
        excess = self.frames.tension_N - self.rig.preload_N
        give = sheath_compliance(self.rig) / self.frames.slip.shape[1]
        stretch = np.cumsum(0.5 * give * (excess[:, 1:] + excess[:, :-1]), axis=1)
        at_mouth = self.x_in_mm - compliance_at_drive(self.rig) * excess[:, 0]
        return np.column_stack((at_mouth, at_mouth[:, None] - stretch))


def follow(
    run: Run,
    time_s: Floats,
    drive: DriveInput,
    models: Mapping[Which, Model],
    tensions: Sequence[Floats],
    dynamics: Dynamics = "slip",
    nodes: int | None = None,
) -> dict[Which, TendonStates]:
    """Follow a run with each model, all at the same moments.

    Parameters
    ----------
    run, time_s, drive
        The run, the time of its samples, shape (n,), and what is given at its ends.
    models
        What follows it.
    tensions
        Tensions that the models have answered, shape (n,) each, which tell when to look.
    dynamics, nodes
        As `simulate` takes them. The lumped model does not say what is along the tendon: with it
        nothing is found.
    """
    at = moments(time_s, tensions, turns(drive.values))
    found = {}
    for which, model in models.items():
        rig = model.rig(run)
        prediction = simulate(
            rig, drive, dynamics, on_mesh=nodes is not None, nodes=nodes, looked_at=at
        )
        if prediction.frames is not None:
            found[which] = TendonStates(
                rig,
                run.started,
                time_s,
                prediction,
                prediction.frames,
                passages(prediction.x_in_mm, prediction.phase),
            )
    return found


def moments(time_s: Floats, tensions: Sequence[Floats], turns: Indices) -> Indices:
    """Return the samples to look at, rising, the turns, the first and the last one among them.

    Parameters
    ----------
    time_s
        Time of the samples, shape (n,).
    tensions
        What must not jump from one to the next: tensions of all models shown, shape (n,) each.
    turns
        Samples at which the drive turns, shape (p,).
    """
    steps = PER_SECOND * np.diff(time_s)
    for tension in tensions:
        there = tension[np.isfinite(tension)]
        span = float(np.ptp(there)) if there.size else 0.0
        if span > 0.0:
            steps = np.fmax(steps, PER_SPAN / span * np.abs(np.diff(tension)))
    passed = np.concatenate(([0.0], np.cumsum(steps)))
    frames = np.searchsorted(passed, np.arange(0.0, passed[-1], max(1.0, passed[-1] / MOST)))
    some = turns[:: 1 + turns.size // MOST]
    return np.unique(np.concatenate((frames, some, [time_s.size - 1])).astype(np.int64))
