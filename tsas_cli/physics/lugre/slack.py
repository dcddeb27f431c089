"""The slack tendon: when it is slack, until when, and the state from which it tightens."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, unloaded_position
from tsas_cli.physics.course import DRIVE, LOAD, LOST, TIME
from tsas_cli.physics.lugre.ends import F_IN, F_OUT, X_IN, X_OUT, Samples
from tsas_cli.physics.lugre.input import value_at
from tsas_cli.physics.lugre.state import STIFFNESS, LugreLaws
from tsas_cli.physics.phases import SLACK, Phases
from tsas_cli.support.arrays import Floats

HALVINGS = 40  # of the time between two samples


@kernel
def load_position(course: Floats, k: int, t: float, laws: LugreLaws) -> float:
    """Return the position of the load while the tendon is slack [mm]."""
    if laws.load.given == SPRING:
        return unloaded_load(course[LOST, k], laws)
    return value_at(course, LOAD, k, t).value


@kernel
def unloaded_load(lost_N: float, laws: LugreLaws) -> float:
    """Return the position of the load with its spring at rest without tension [mm]."""
    preload_N = laws.preload_N - lost_N - laws.load.hysteresis.force_N
    return unloaded_position(0.0, preload_N, laws.load)


@kernel
def shortening(s: Floats, laws: LugreLaws) -> float:
    """Return the elongation of the tendon at the preload [mm]."""
    total = 0.0
    for j in range(laws.n + 1):
        total += laws.preload_N / s[STIFFNESS + j]
    return total


@kernel
def is_slack(s: Floats, course: Floats, k: int, t: float, laws: LugreLaws) -> bool:
    """Return whether the tendon is slack at a time from sample k to the next."""
    drive = value_at(course, DRIVE, k, t).value
    if laws.drive.given == FORCE:
        return drive <= 0.0
    return drive <= load_position(course, k, t, laws) - shortening(s, laws)


@kernel
def end_of_slack(s: Floats, course: Floats, k: int, t: float, laws: LugreLaws) -> tuple[int, float]:
    """Return the last sample before the tendon tightens, and the time when it does.

    Where it does not, the last sample and its time are returned.
    """
    last = course.shape[1] - 1
    while k < last and is_slack(s, course, k, course[TIME, k + 1], laws):
        k += 1
    if k == last:
        return last, course[TIME, last]
    slack, pulled = max(t, course[TIME, k]), course[TIME, k + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (slack + pulled)
        if is_slack(s, course, k, middle, laws):
            slack = middle
        else:
            pulled = middle
    return k, pulled


@kernel
def write_slack(
    columns: Floats, phase: Phases, within: Samples, s: Floats, course: Floats, laws: LugreLaws
) -> None:
    """Write the samples of a slack tendon."""
    for i in range(within.first, within.end):
        x_out = load_position(course, i, course[TIME, i], laws)
        columns[X_IN, i], columns[X_OUT, i] = course[DRIVE, i], x_out
        columns[F_IN, i] = columns[F_OUT, i] = 0.0
        if laws.drive.given == FORCE:
            columns[X_IN, i], columns[F_IN, i] = x_out - shortening(s, laws), course[DRIVE, i]
        phase[i] = SLACK


@kernel
def slack_state(s: Floats, load: float, laws: LugreLaws) -> Floats:
    """Return a taut tendon without tension up to the load's position, shape (2, n + 2)."""
    start = np.zeros((2, laws.n + 2))
    start[0, laws.n + 1] = load
    for j in range(laws.n, -1, -1):
        start[0, j] = start[0, j + 1] - laws.preload_N / s[STIFFNESS + j]
    return start
