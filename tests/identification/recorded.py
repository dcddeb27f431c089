"""Recordings of the independent rig, prepared for a model, as several tests need them."""

from dataclasses import replace
from functools import cache

import numpy as np

from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.recording import Recording
from tsas_studies.challenge.rig.motions import Motion, sine
from tsas_studies.challenge.rig.recordings import DATA_SHEET, conditions
from tsas_studies.challenge.rig.sensors import Sensors, measure
from tsas_studies.challenge.rig.tendon import Rig, simulate

ALL = ("f_in_N", "f_out_N", "x_out_mm")
CELLS = 60  # 0.013 N off a rig of 200 at the most, where it turns; sensors have noise of 0.08 N
RATE_HZ = 250.0  # of the rig; 0.01 N off one of 1000 Hz at a reversal
TRUE = Rig(friction_coefficient=0.135, load_stiffness_N_per_mm=1.45, preload_N=27.0)
VALUES = {
    "friction_coefficient": 0.135,
    "load_stiffness_N_per_mm": 1.45,
    "preload_N": 27.0,
    "tendon_stiffness_N": TRUE.axial_stiffness,
}


@cache
def _simulated(rig: Rig, time_s: bytes, x_in_mm: bytes):
    return simulate(rig, Motion(np.frombuffer(time_s).copy(), np.frombuffer(x_in_mm).copy()))


def clean(rig: Rig, motion=None):
    """Return the rig's run without sensor errors, straight between the samples of the rig."""
    moved = motion or sine()
    every = max(round(1.0 / (RATE_HZ * moved.time_s[1])), 1)
    at = np.unique(np.append(np.arange(0, moved.time_s.size, every), moved.time_s.size - 1))
    run = _simulated(
        replace(rig, cells=CELLS), moved.time_s[at].tobytes(), moved.x_in_mm[at].tobytes()
    )
    columns = {n: np.interp(moved.time_s, run.time_s, v) for n, v in run.columns.items()}
    return replace(run, columns=columns)


def prepared(rig: Rig, motion=None, *, seed=0, channels=ALL, run_id="a", sensors=None, **said):
    """Measure a run and prepare it; `said` replaces what the manifest tells."""
    columns = measure(clean(rig, motion), sensors or Sensors(), seed=seed)
    kept = {n: v for n, v in columns.items() if n in channels or n in ("time_s", "x_in_mm")}
    return ran(kept, run_id=run_id, **conditions(rig) | said)


def ran(columns, *, run_id="a", **told):
    """Prepare columns as a run of which the manifest tells that much."""
    run = Run(id=run_id, file=f"{run_id}.parquet", sha256="0" * 64, **told)
    return prepare(Recording(run, columns))


def manifest(*runs: Prepared, **sheet: float) -> Manifest:
    """Return a manifest of prepared runs, with Table 1 of Yang 2025 as data sheet."""
    return Manifest(
        format=1, name="t", kind="simulated", rig=DATA_SHEET | sheet, run=tuple(r.run for r in runs)
    )
