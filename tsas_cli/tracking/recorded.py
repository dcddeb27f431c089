"""A run of the closed loop as a recording: what the sensors read, in a dataset of format 1."""

from collections.abc import Mapping

import numpy as np
import pyarrow as pa

from tsas_cli.controllers.closed_loop import (
    ASKED,
    DISTANCE,
    F_IN,
    F_OUT,
    MEMORY_AT,
    X_OUT,
    X_SEEN,
)
from tsas_cli.controllers.path import DrivePath
from tsas_cli.controllers.sliding_mode import SlidingSettings
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.course import Output
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import Channel, new_memory, reading, sensed
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.manifest import RigSheet as DataSheet
from tsas_cli.support.arrays import Floats
from tsas_cli.tracking.settings import Settings
from tsas_cli.tracking.track import Tracked

NO_CHECKSUM = "0" * 64  # until the run's file is written
NOISE = 1  # of the streams of a seed; the loop's own is another


def table_of(
    run: Tracked, path: DrivePath, rig: Rig, controller: str, seed: int, settings: Settings
) -> pa.Table:
    """Return the recording of a run, with what the controller wanted and remembered."""
    rng = np.random.default_rng((seed, NOISE))
    sensor, time_s, columns = settings.sensor, run.time_s, run.columns

    x_in, phase = columns[X_SEEN], np.zeros(time_s.size, dtype=np.int8)
    true = Output(x_in, columns[X_OUT], columns[F_IN], columns[F_OUT], phase)
    signals = sensed(true, time_s, rig, Boundary(DISPLACEMENT, SPRING), new_memory())

    def seen(channel: Channel, values: Floats, noise: float) -> Floats:
        read = reading(channel, values, time_s, rig)
        return read + noise * rng.standard_normal(read.size)

    table = {
        "time_s": time_s,
        "x_in_mm": x_in,
        "x_out_mm": seen("x_out_mm", signals.x_out, sensor.noise_mm),
        "f_in_N": seen("f_in_N", signals.f_in, sensor.force_noise_N),
        "f_out_N": seen("f_out_N", signals.f_out, sensor.force_noise_N),
        "motor_speed_rpm": columns[ASKED],
        "f_out_ref_N": run.wanted_N,
        "f_out_true_N": columns[F_OUT],
        "x_inv_mm": path.drive[0, : time_s.size],
    }
    gains = settings.controllers.of(controller)
    if isinstance(gains, SlidingSettings):
        table["sliding_distance_mm_per_s2"] = columns[DISTANCE]
    for i, name in enumerate(gains.COLUMNS):
        table[name] = columns[MEMORY_AT + i]
    return pa.table({name: pa.array(values) for name, values in table.items()})


def conditions(run_id: str, settings: Settings) -> Run:
    """Return a run of a manifest with the settings' conditions."""
    return Run(
        id=run_id,
        file=f"runs/{run_id}.parquet",
        sha256=NO_CHECKSUM,
        sheath_length_mm=settings.rig.sheath_length_mm,
        total_bend_rad=settings.rig.total_bend_rad,
        preload_N=settings.rig.preload_N,
    )


def stated_model(settings: Settings) -> Model:
    """Return the model that the settings' data sheet states."""
    return data_sheet(manifest(("track",), settings))


def stated_rig(settings: Settings) -> Rig:
    """Return the rig of that model under the settings' conditions."""
    return stated_model(settings).rig(conditions("track", settings))


def manifest(run_ids: Mapping[str, object] | tuple[str, ...], settings: Settings) -> Manifest:
    """Return the manifest of tracked runs; its data sheet is the settings'."""
    stated = {**settings.rig.model_dump(), **settings.drive.model_dump()}
    sheet = {key: value for key, value in stated.items() if key in DataSheet.model_fields}
    return Manifest(
        format=1,
        name="tracking",
        kind="simulated",
        description="Simulated, not measured: closed loop of tsas track, with sensor noise.",
        rig=DataSheet(**sheet),
        run=tuple(conditions(run_id, settings) for run_id in run_ids),
    )
