"""From a wanted force to the path of the drive: the inverse model, and how its jumps are crossed.

The inverse model jumps over the dead band where the wanted force turns. The path is smoothed by a
B-spline of fourth order (four moving means in a row, each a quarter of `crossing_s` long, centred,
so that the path is known ahead and nothing comes late): a jump is crossed in `crossing_s` with
continuous speed and acceleration, and rates are exact differences of the means. Where the path is
smooth already, that adds x″ crossing_s²/96. The ripple of the gear is taken back last, unsmoothed.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.effects import Effects
from tsas_cli.effects.drive_friction import drive_friction_force
from tsas_cli.effects.drive_ripple import DriveRipple, rippled
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.ends import last_direction, losses_over
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.inverse import inverse_chain
from tsas_cli.support.errors import InputError

Floats = npt.NDArray[np.float64]
MEANS = 4
PASSES = 4  # of the path, where friction depends on its speed
HALVINGS = 50  # of the ripple's height, in which the drive is sought


@dataclass(frozen=True)
class DrivePath:
    """Where the drive has to be, shape (4, m): place, speed, acceleration and jerk [mm, s].

    `motor` is the same of the motor, which winds up the gear by the force at the drive over its
    stiffness. `missed` counts the samples whose force no place gives.
    """

    drive: Floats
    motor: Floats
    missed: int


def follow(
    wanted_N: Floats, step_s: float, rig: Rig, actuator: Actuator, *, crossing_s: float, nodes: int
) -> DrivePath:
    """Return the path that gives the load a wanted force, shape (m,), by a model of the rig.

    Before and after it the force stays at its first and last value.

    Raises
    ------
    InputError
        The reference is shorter than the crossing.
    """
    width = max(round(crossing_s / step_s / MEANS), 1)
    if wanted_N.size < MEANS * width:
        raise InputError(
            f"a reference of {wanted_N.size * step_s:g} s",
            expected=f"at least {crossing_s:g} s, the time in which a dead band is crossed",
            remedy="use a longer reference or a shorter crossing",
        )
    ahead = MEANS * width // 2
    held = np.concatenate(
        (np.full(ahead, wanted_N[0]), wanted_N, np.full(MEANS * width - ahead, wanted_N[-1]))
    )
    time_s = (np.arange(held.size) - ahead) * step_s
    speed = np.zeros(held.size)
    for _ in range(PASSES if _depends_on_speed(rig.effects) else 1):
        losses = losses_over(np.maximum(time_s, 0.0), speed, 0.0, rig)
        end, tension, missed = inverse_chain(held, losses, step_s, rig, nodes)
        smooth = smoothed(end, width, step_s)[1]
        speed = np.concatenate((np.zeros(ahead), smooth, np.zeros(held.size - ahead - smooth.size)))
    geared = smoothed(geared_at(end, rig.effects), width, step_s)
    direction = last_direction(end)
    force = tension - rig.preload_N
    force += drive_friction_force(1.0, rig.effects.drive_friction.friction_N) * direction
    force += proximal_spring_force(1.0, rig.effects.proximal_spring.stiffness_N_per_mm) * end
    drive = drive_at(geared, rig.effects.drive_ripple, step_s)
    wound = smoothed(force / actuator.stiffness_N_per_mm, width, step_s)
    return DrivePath(drive, drive + wound, missed)


def geared_at(end: Floats, effects: Effects) -> Floats:
    """Return where the gear's output is for places of the tendon's end, come to from 0: play."""
    direction = last_direction(np.concatenate(([0.0], end)))[1:]
    geared: Floats = end + 0.5 * effects.backlash.play_mm * direction
    return geared


def drive_at(geared: Floats, ripple: DriveRipple, step_s: float) -> Floats:
    """Return place and three rates of the drive for those of the gear's output, shape (4, m)."""
    if ripple.sine_mm == ripple.cosine_mm == 0.0:
        return geared
    rows = [unrippled(geared[0], ripple)]
    for _ in range(3):
        rows.append(np.gradient(rows[-1], step_s))
    return np.vstack(rows)


@kernel
def unrippled(geared: Floats, ripple: DriveRipple) -> Floats:
    """Return where the drive is for places of the gear's output, by bisection."""
    drive = np.empty(geared.size)
    reach = abs(ripple.sine_mm) + 2.0 * abs(ripple.cosine_mm)
    for i in range(geared.size):
        low, high = geared[i] - reach, geared[i] + reach
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if rippled(middle, ripple) < geared[i]:
                low = middle
            else:
                high = middle
        drive[i] = 0.5 * (low + high)
    return drive


def smoothed(x: Floats, width: int, step_s: float) -> Floats:
    """Return the smoothed x and its first three derivatives, shape (4, m − 4 width)."""
    levels = [x]
    for _ in range(MEANS):
        levels.append(_mean(levels[-1], width))
    rows = []
    for order in range(MEANS):
        rate = levels[MEANS - order]
        for _ in range(order):
            rate = (rate[width:] - rate[:-width]) / (width * step_s)
        rows.append(rate)
    return np.vstack(rows)


def _mean(x: Floats, width: int) -> Floats:
    """Return the mean over each `width` steps (trapezoidal), shape (n − width,)."""
    total = np.concatenate(([0.0], np.cumsum(0.5 * (x[1:] + x[:-1]))))
    mean: Floats = (total[width:] - total[:-width]) / width
    return mean


def _depends_on_speed(effects: Effects) -> bool:
    return (
        effects.stribeck_friction.excess != 0.0
        or effects.viscous_friction.coefficient_N_s_per_mm != 0.0
    )
