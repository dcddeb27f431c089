"""A run of the closed loop as a recording: what the sensors read, in a dataset of format 1.

Below it is what of tracked runs is not to be trusted or not to be reached, and why.
"""

from collections.abc import Iterator, Mapping, Sequence

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
from tsas_cli.effects.laws.drive_law import DriveLaw
from tsas_cli.identification.comparison import unstable_sliding
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING, Boundary
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.course import Output
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import Channel, new_memory, reading, sensed
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.recordings.manifest import RigSheet as DataSheet
from tsas_cli.records.tracking import TrackedResult
from tsas_cli.support.arrays import Floats
from tsas_cli.tracking.conditions import Condition
from tsas_cli.tracking.settings import Settings
from tsas_cli.tracking.track import Known, Plant, Tracked, feedforward

OFTEN_PERCENT = 5.0  # of the time at the motor's limit, from which it is said
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
    rig = rig._replace(effects=rig.effects._replace(drive_law=DriveLaw()))
    signals = sensed(true, time_s, rig, Boundary(DISPLACEMENT, SPRING), new_memory())

    def seen(channel: Channel, values: Floats, noise: float) -> Floats:
        read = reading(channel, values, time_s, 0.0, rig)
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


def run_notes(
    path: DrivePath, known: Known, plant: Plant, results: Sequence[TrackedResult]
) -> Iterator[str]:
    """Yield what of the runs is not to be trusted or not to be reached, and why."""
    if path.missed:
        yield f"{path.missed} samples of the wanted force are met by no place of the drive"
    limit, asked = plant.actuator.speed_limit_rpm, np.abs(feedforward(path, known.actuator))
    if (asked > limit).any():
        yield (
            f"the reference asks for more than the motor's {limit:g} rpm in "
            f"{(asked > limit).sum()} samples, up to {asked.max():.0f} rpm"
        )
    for result in results:
        at_limit = result.scores.at_limit_percent.mean or 0.0
        if at_limit > OFTEN_PERCENT:
            relay = "; the loop is a relay" if result.relay else ""
            yield f"{result.run}: the motor is at its limit for {at_limit:.0f} % of the time{relay}"
        if result.unsettled_steps:
            yield f"{result.run}: {result.unsettled_steps} steps of the tendon did not settle"


def dynamic_notes(
    path: DrivePath, plant: Plant, conditions: Sequence[Condition], step_s: float
) -> Iterator[str]:
    """Say what of the plant's dynamic tendon is not its own, and where it would stick and slip.

    Looked at is the path of the drive that the controller wants.
    """
    if plant.rig.bristles.stiffness_N_per_mm == Bristles().stiffness_N_per_mm:
        yield "the stiffness of the plant's bristles is that of Yang 2025, Table 1"
    time_s = step_s * np.arange(path.drive.shape[1], dtype=np.float64)
    for condition in conditions:
        real = condition.of(plant)
        for rig in (real.rig,) if real.later is None else (real.rig, real.later):
            drive = DriveInput(path.drive[0] + rig.x_in_zero_mm, time_s=time_s)
            for sentence in unstable_sliding(rig, time_s, drive):
                yield f"{condition.name}: {sentence}"
