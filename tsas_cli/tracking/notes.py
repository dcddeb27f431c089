"""What runs with a dynamic tendon say of themselves: borrowed bristles, unstable sliding."""

from collections.abc import Iterator, Sequence

import numpy as np

from tsas_cli.controllers.path import DrivePath
from tsas_cli.identification.dynamic_notes import unstable_sliding
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.tracking.conditions import Condition
from tsas_cli.tracking.track import Plant


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
