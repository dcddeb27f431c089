"""What of tracked runs is not to be trusted or not to be reached, and why."""

from collections.abc import Iterator, Sequence

import numpy as np

from tsas_cli.controllers.path import DrivePath
from tsas_cli.effects import LAWS, Effects
from tsas_cli.identification.dynamic_notes import unstable_sliding
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.records.tracking import TrackedResult
from tsas_cli.tracking.conditions import Condition
from tsas_cli.tracking.track import Known, Plant, feedforward

OFTEN_PERCENT = 5.0  # of the time at the motor's limit, from which it is said


def run_notes(
    path: DrivePath, known: Known, plant: Plant, results: Sequence[TrackedResult]
) -> list[str]:
    """Return what of the runs is not to be trusted or not to be reached, and why."""
    notes = []
    if path.missed:
        notes.append(f"{path.missed} samples of the wanted force are met by no place of the drive")
    limit = plant.actuator.speed_limit_rpm
    beyond = np.abs(feedforward(path, known.actuator)) > limit
    if beyond.any():
        notes.append(
            f"the reference asks for more than the motor's {limit:g} rpm in {beyond.sum()} samples,"
            f" up to {np.abs(feedforward(path, known.actuator)).max():.0f} rpm"
        )
    neutral, effects = Effects(), plant.rig.effects
    laws = [law.name for law in LAWS if getattr(effects, law.name) != getattr(neutral, law.name)]
    if laws:
        notes.append(
            f"{' and '.join(laws)} of the model describe recordings: the plant moves without them"
        )
    for result in results:
        at_limit = result.scores.at_limit_percent.mean or 0.0
        if at_limit > OFTEN_PERCENT:
            notes.append(
                f"{result.run}: the motor is at its limit for {at_limit:.0f} % of the time"
                + ("; the loop is a relay" if result.relay else "")
            )
        if result.unsettled_steps:
            notes.append(
                f"{result.run}: {result.unsettled_steps} steps of the tendon did not settle"
            )
    return notes


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
