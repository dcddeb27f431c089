"""Simulated recordings of planned runs: predictions of the nominal rig, with noise."""

import math
from collections.abc import Callable, Sequence
from datetime import datetime, timedelta

import numpy as np

from tsas_cli.diagnosis.motions import STAIRS, motion
from tsas_cli.diagnosis.rig_file import MOST_SAMPLES, PlannedRun, Sensors
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.errors import InputError

SEED = 1  # the same plan gives the same numbers
APART = timedelta(minutes=5)  # from the end of one run to the start of the next


def simulated_recordings(
    runs: Sequence[PlannedRun],
    sensors: Sensors,
    rig_of: Callable[[Run], Rig],
    started: datetime,
    *,
    seed: int = SEED,
) -> list[Recording]:
    """Return simulated recordings of planned runs, one after the other from `started` on.

    `rig_of` gives the rig in a run's conditions, `started` is the start of the first run, and the
    seed is that of the noise.

    InputError: a run is too long.
    """
    rng = np.random.default_rng(seed)
    out = []
    for planned in runs:
        t, x = _moved(planned, sensors.rate_Hz)
        conditions = planned.model_dump(include={"sheath_length_mm", "total_bend_rad", "preload_N"})
        file = f"runs/{planned.id}.parquet"
        run = Run(id=planned.id, file=file, sha256="0" * 64, started=started, **conditions)
        predicted = simulate(rig_of(run), DriveInput(x, time_s=t))
        columns = {"time_s": t, "x_in_mm": x + sensors.x_in_mm * rng.standard_normal(t.size)}
        for name, sd in sensors.outputs.items():
            columns[name] = getattr(predicted, name) + sd * rng.standard_normal(t.size)
        out.append(Recording(run, columns))
        started += timedelta(seconds=float(t[-1])) + APART
    return out


def _moved(run: PlannedRun, rate_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    travel = 2.0 * run.amplitude_mm * run.periods * 2.0
    # The slowest motion is loops within loops, in half sines; a staircase has most rests.
    most_s = math.pi * travel / run.speed + len(STAIRS) * run.periods * run.dwell_s
    if most_s * rate_Hz > MOST_SAMPLES:
        raise InputError(
            f"run {run.id} would take more than {MOST_SAMPLES} samples",
            remedy="is its speed_mm_per_s or frequency_Hz right?",
        )
    return motion(
        run.motion,
        amplitude_mm=run.amplitude_mm,
        speed_mm_per_s=run.speed,
        periods=run.periods,
        dwell_s=run.dwell_s,
        rate_Hz=rate_Hz,
    )
