"""From a reference force to the path of the drive: the inverse model and the crossing of its jumps.

The inverse model jumps over the dead band where the reference force reverses. The path is smoothed
by a B-spline of fourth order (four moving means in a row, each a quarter of `crossing_s` long,
centred, hence without delay): a jump is crossed in `crossing_s` with continuous speed and
acceleration, and rates are exact differences of the means. Where the path is smooth already, that
adds x″ crossing_s²/96. The ripple of the gear is inverted last, unsmoothed.
"""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.effects import Effects
from tsas_cli.effects.laws.drive_law import DriveLaw, drive_law_force
from tsas_cli.effects.laws.tendon_law import tendon_law_factor
from tsas_cli.effects.stribeck_friction import StribeckFriction, stribeck_factor
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.stops import ELEMENTS, GAPS
from tsas_cli.numerics.wave import Wave, rippled, wave_from
from tsas_cli.physics.course import PULLED, RELEASED
from tsas_cli.physics.ends import (
    NO_TENDON_LAW,
    force_at_drive,
    force_of_motion,
    last_direction,
    losses_over,
    rate_of,
    since_reversal,
)
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.inverse import inverse_chain
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

MEANS = 4
ITERATIONS = 4  # of the path, where friction depends on it or its speed
HALVINGS = 50  # bisections of the interval of the ripple's height


@dataclass(frozen=True)
class DrivePath:
    """Path of the drive, shape (4, m): position, speed, acceleration and jerk [mm, s].

    `motor` is the same of the motor, which leads by the force at the drive over the gear's
    stiffness. `missed` counts the samples whose force is unreachable.
    """

    drive: Floats
    motor: Floats
    missed: int


def follow(
    wanted_N: Floats, step_s: float, rig: Rig, actuator: Actuator, *, crossing_s: float, nodes: int
) -> DrivePath:
    """Return the drive's path for a reference force at the load, shape (m,), by a model of the rig.

    Before and after the reference the force is constant at its first and last value.

    InputError: the reference is shorter than the crossing.
    """
    width = max(round(crossing_s / step_s / MEANS), 1)
    if wanted_N.size < MEANS * width:
        raise InputError(
            f"a reference of {wanted_N.size * step_s:g} s",
            expected=f"at least {crossing_s:g} s, the time in which a dead band is crossed",
            remedy="use a longer reference or a shorter crossing",
        )
    ahead = MEANS * width // 2
    padded = np.concatenate(
        (np.full(ahead, wanted_N[0]), wanted_N, np.full(MEANS * width - ahead, wanted_N[-1]))
    )
    time_s = (np.arange(padded.size, dtype=np.float64) - ahead) * step_s
    end = speed = np.zeros(padded.size)
    stribeck = rig.effects.stribeck_friction
    # The inverse crosses a dead band at once: only the smoothed path has a speed.
    by_drive = rig._replace(effects=rig.effects._replace(stribeck_friction=StribeckFriction()))
    depends_on_path = (
        rig.effects.position_dependent_friction.slope_per_mm != 0.0
        or stribeck.excess != 0.0
        or rig.effects.viscous_friction.coefficient_N_s_per_mm != 0.0
        or rig.effects.tendon_law != NO_TENDON_LAW
    )
    for _ in range(ITERATIONS if depends_on_path else 1):
        losses = losses_over(np.maximum(time_s, 0.0), end, speed, 0.0, rig)
        if stribeck.excess != 0.0:
            losses[[PULLED, RELEASED]] *= [stribeck_factor(v, stribeck) for v in speed]
        come = np.concatenate(([0.0], end))  # from x_in = 0
        travel = since_reversal(come, last_direction(come), math.inf)[1:]
        losses[[PULLED, RELEASED]] *= tendon_law_factor(rig.effects.tendon_law, end, travel, speed)
        end, tension, missed = inverse_chain(padded, losses, step_s, by_drive, nodes)
        smooth = smoothed(end, width, step_s)[1]
        speed = np.concatenate(
            (np.zeros(ahead), smooth, np.zeros(padded.size - ahead - smooth.size))
        )
    geared = smoothed(geared_at(end, rig.effects), width, step_s)
    of_motion = force_of_motion(rate_of(end, time_s), time_s, rig.effects)
    force = tension - rig.preload_N
    force += force_at_drive(end, last_direction(end), of_motion, rig.effects)
    force += law_force(end, speed, force + rig.preload_N, rig.effects.drive_law)
    ripple = wave_from(rig.effects.drive_ripple, rig.x_in_zero_mm)
    drive = drive_at(geared, ripple, step_s)
    wound = smoothed(force / actuator.stiffness_N_per_mm, width, step_s)
    return DrivePath(drive, drive + wound, missed)


def law_force(end: Floats, speed: Floats, tension: Floats, law: DriveLaw) -> Floats:
    """Return the force of the drive's law along the path of the tendon's end, from x_in = 0 [N]."""
    x, v, beside = (np.concatenate(([0.0], values)) for values in (end, speed, tension))
    return drive_law_force(law, x, x, v, beside, np.full(1 + ELEMENTS + GAPS, np.nan))[1:]


def geared_at(end: Floats, effects: Effects) -> Floats:
    """Return the gear's output for positions of the tendon's end, with play, from x_in = 0."""
    direction = last_direction(np.concatenate(([0.0], end)))[1:]
    return end + 0.5 * effects.backlash.play_mm * direction


def drive_at(geared: Floats, ripple: Wave, step_s: float) -> Floats:
    """Return position and three rates of the drive for those of the gear's output, shape (4, m)."""
    if ripple.is_flat:
        return geared
    rows = [unrippled(geared[0], ripple, ripple.reach_mm)]
    for _ in range(3):
        rows.append(np.gradient(rows[-1], step_s))
    return np.vstack(rows)


@kernel
def unrippled(geared: Floats, ripple: Wave, reach_mm: float) -> Floats:
    """Return the drive's positions for those of the gear's output, by bisection."""
    drive = np.empty(geared.size)
    for i in range(geared.size):
        low, high = geared[i] - reach_mm, geared[i] + reach_mm
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if rippled(middle, ripple) < geared[i]:
                low = middle
            else:
                high = middle
        drive[i] = 0.5 * (low + high)
    return drive


def smoothed(x: Floats, width: int, step_s: float) -> Floats:
    """Return smoothed x and its first three derivatives, shape (4, m − 4 width)."""
    levels = [x]
    for _ in range(MEANS):  # trapezoidal means over each `width` steps
        last = levels[-1]
        total = np.concatenate(([0.0], np.cumsum(0.5 * (last[1:] + last[:-1]))))
        levels.append((total[width:] - total[:-width]) / width)
    rows = []
    for order in range(MEANS):
        rate = levels[MEANS - order]
        for _ in range(order):
            rate = (rate[width:] - rate[:-width]) / (width * step_s)
        rows.append(rate)
    return np.vstack(rows)
