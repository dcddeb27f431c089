"""Notes on a prediction of the dynamic model: unstable sliding, default bristles, an abort."""

import math
from collections.abc import Iterator

import numpy as np

from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import MOST_PER_SAMPLE, MOST_TRIES
from tsas_cli.physics.lugre.stability import Stability, stability
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.physics.response import Prediction, simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

MANY_STEPS = 10  # steps for each sample
HIGH_DAMPING = 3.0  # times critical, from which the bristles are the cause of unstable sliding


def dynamic_notes(run: Prepared, model: Model, response: Prediction) -> Iterator[str]:
    """Yield notes on what makes the dynamic model's prediction of a run unreliable."""
    rig = model.rig(run.run)
    if model.value("bristles.stiffness_N_per_mm") is None:
        yield (
            "the bristles are those of Yang 2025, Table 1: the model has no "
            "[bristles.stiffness_N_per_mm] of this rig"
        )
    yield from unstable_sliding(rig, run.time_s, run.drive)
    steps, samples = response.step_ends_s.size, run.time_s.size
    if steps > MANY_STEPS * samples:
        yield (
            f"{steps} steps for {samples} samples: the tendon sticks and slips, or its load rings, "
            "much faster than the sampling resolves"
        )
    aborted = response.phase == UNCONVERGED
    if np.any(aborted):
        yield (
            f"aborted at {run.time_s[np.argmax(aborted)]:.4g} s, after {MOST_TRIES} steps and "
            f"{MOST_PER_SAMPLE} more for each sample: later samples are not simulated"
        )


def unstable_sliding(rig: Rig, time_s: Floats, drive: DriveInput) -> Iterator[str]:
    """Yield a note on the most unstable moment of sliding in a run, if there is one."""
    slow = simulate(rig, drive)
    found = stability(rig, time_s, slow.x_in_mm, slow.f_in_N, slow.phase)
    if found is not None and found.unstable:
        yield _unstable(found, rig)


def _unstable(found: Stability, rig: Rig) -> str:
    moment = found.moment
    where = "where the whole tendon slides" if moment.whole else "in a dead band"
    sentence = (
        f"sliding is unstable {where}, at {moment.speed_mm_s:.3g} mm/s and f_in of "
        f"{moment.f_in_N:.3g} N: a disturbance grows e-fold in {1e3 / found.growth_per_s:.2g} ms"
    )
    critical = rig._replace(bristles=rig.bristles._replace(damping_N_s_per_mm=math.nan))
    ratio = bristles_of(rig).damping / bristles_of(critical).damping
    if ratio > HIGH_DAMPING:
        return (
            f"{sentence}; the bristles' damping is {ratio:.3g} times critical; without "
            "[bristles.damping_N_s_per_mm] it is critical"
        )
    return f"{sentence}; friction falls with speed by more than the damping"
