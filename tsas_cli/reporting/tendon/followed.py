"""A run followed along the tendon, with one model or with two at the same moments."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.comparison import simulated
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.passages import Passage, passages
from tsas_cli.physics.response import Dynamics, Response
from tsas_cli.physics.rig import Rig
from tsas_cli.reporting.tendon.moments import moments

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Followed:
    """What one model says along the tendon of a run, at k moments.

    `time_s`, shape (k,), is on the recording's own clock; `front_runs` are of all samples, whose
    times are `sample_time_s`.
    """

    rig: Rig
    response: Response
    frames: Frames
    time_s: Floats
    sample_time_s: Floats
    front_runs: list[Passage]

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


def follow(
    run: Prepared,
    models: Mapping[str, Model],
    dynamics: Dynamics = "slip",
    nodes: int | None = None,
) -> dict[str, Followed]:
    """Follow a run with each model, all at the same moments.

    The lumped model does not say what is along the tendon: it gives none.
    """
    if dynamics == "static":
        return {}
    answers = [simulated(run, model, dynamics, nodes) for model in models.values()]
    at = moments(run.time_s, [answer.f_in_N for answer in answers])
    found = {}
    for name, model in models.items():
        answer = simulated(run, model, dynamics, nodes, looked_at=at)
        if answer.frames is not None:
            found[name] = Followed(
                model.rig(run.run),
                answer,
                answer.frames,
                run.time_s[at],
                run.time_s,
                passages(answer.x_in_mm, answer.phase),
            )
    return found
