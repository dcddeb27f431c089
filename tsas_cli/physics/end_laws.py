"""What the laws of unnamed origin at both ends of the tendon do to its signals."""

import numpy as np

from tsas_cli.effects.laws.drive_law import DriveLaw, drive_law_force
from tsas_cli.effects.laws.load_law import LoadLaw, load_law_motion
from tsas_cli.numerics.stops import ELEMENTS, GAPS
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, Boundary
from tsas_cli.physics.course import Output
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

NO_DRIVE_LAW, NO_LOAD_LAW = DriveLaw(), LoadLaw()
LAW_MEMORY = 2 + ELEMENTS + GAPS


def with_laws(
    output: Output,
    time_s: Floats | None,
    rig: Rig,
    boundary: Boundary,
    memory: Floats,
    motor_mm: Floats | None,
) -> Output:
    """Return an output with the laws of unnamed origin at both ends, but for a given quantity.

    `memory` has a row for each of f_in, f_out and x_out: time, input and states of the elements of
    the law that acts on it, NaN before the first sample, shape (3, LAW_MEMORY), updated in place.
    """
    effects, f_in, x_out = rig.effects, output.f_in, output.x_out
    if boundary.drive != FORCE and effects.drive_law != NO_DRIVE_LAW:
        moved = output.x_in if motor_mm is None else motor_mm
        speed = backward_rate(moved, time_s, memory[0])
        f_in = f_in + drive_law_force(
            effects.drive_law, output.x_in, moved, speed, f_in, memory[0, 1:]
        )
    if boundary.load != DISPLACEMENT and effects.load_law != NO_LOAD_LAW:
        x_out = x_out + load_law_motion(effects.load_law, x_out, output.f_out, memory[2, 1:])
    return output._replace(f_in=f_in, x_out=x_out)


def backward_rate(values: Floats, time_s: Floats | None, memory: Floats) -> Floats:
    """Return the mean rate of a signal since the sample before, shape (n,), 0 where there is none.

    `memory` has time and value of the sample before; the time is updated in place.
    """
    if time_s is None:
        return np.zeros(values.size)
    before, memory[0] = memory[0], time_s[-1]
    changes, steps_s = np.diff(values, prepend=memory[1]), np.diff(time_s, prepend=before)
    rate: Floats = np.nan_to_num(changes / steps_s, nan=0.0, posinf=0.0, neginf=0.0)
    return rate
