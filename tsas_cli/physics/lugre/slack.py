"""The tendon hangs slack: where it does, until when, and from what state it is pulled again."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, Boundary, unloaded_position
from tsas_cli.physics.lugre.ends import F_IN, F_OUT, X_IN, X_OUT
from tsas_cli.physics.lugre.input import DRIVE, LOAD, LOST, value_at
from tsas_cli.physics.lugre.state import STIFFNESS, Floats, LugreLaws
from tsas_cli.physics.phases import SLACK, Phases

HALVINGS = 40  # of the time between two samples


@kernel
def load_position(
    times: Floats, course: Floats, k: int, t: float, boundary: Boundary, law: LugreLaws
) -> float:
    """Return where the load is while the tendon is slack [mm]."""
    if boundary.load == SPRING:
        return unloaded_load(course[LOST, k], law)
    return value_at(times, course, LOAD, k, t)[0]


@kernel
def unloaded_load(lost_N: float, law: LugreLaws) -> float:
    """Return where the load's spring is at rest without a pull [mm]."""
    preload_N = law.preload_N - lost_N
    return unloaded_position(0.0, preload_N, law.load_stiffness_N_per_mm, law.load_spring)


@kernel
def shortening(s: Floats, law: LugreLaws) -> float:
    """Return by how much the tendon without tension is shorter than at the preload [mm]."""
    total = 0.0
    for j in range(law.n + 1):
        total += law.preload_N / s[STIFFNESS + j]
    return total


@kernel
def is_slack(
    s: Floats, times: Floats, course: Floats, k: int, t: float, boundary: Boundary, law: LugreLaws
) -> bool:
    """Say whether nothing pulls at a time from sample k to the next."""
    drive = value_at(times, course, DRIVE, k, t)[0]
    if boundary.drive == FORCE:
        return drive <= 0.0
    return drive <= load_position(times, course, k, t, boundary, law) - shortening(s, law)


@kernel
def end_of_slack(
    s: Floats, times: Floats, course: Floats, k: int, t: float, boundary: Boundary, law: LugreLaws
) -> tuple[int, float]:
    """Return the sample before the time at which the tendon is pulled again, and that time.

    Without such a time the last sample and its time are returned.
    """
    last = times.size - 1
    while k < last and is_slack(s, times, course, k, times[k + 1], boundary, law):
        k += 1
    if k == last:
        return last, times[last]
    slack, pulled = max(t, times[k]), times[k + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (slack + pulled)
        if is_slack(s, times, course, k, middle, boundary, law):
            slack = middle
        else:
            pulled = middle
    return k, pulled


@kernel
def write_slack(
    columns: Floats,
    phase: Phases,
    s: Floats,
    times: Floats,
    course: Floats,
    samples: tuple[int, int],
    boundary: Boundary,
    law: LugreLaws,
) -> None:
    """Write the samples of a slack tendon, from one to before another."""
    for i in range(samples[0], samples[1]):
        x_out = load_position(times, course, i, times[i], boundary, law)
        columns[X_IN, i], columns[X_OUT, i] = course[DRIVE, i], x_out
        columns[F_IN, i] = columns[F_OUT, i] = 0.0
        if boundary.drive == FORCE:
            columns[X_IN, i], columns[F_IN, i] = x_out - shortening(s, law), course[DRIVE, i]
        phase[i] = SLACK


@kernel
def without_tension(
    s: Floats, times: Floats, course: Floats, k: int, t: float, boundary: Boundary, law: LugreLaws
) -> Floats:
    """Return the state of rest of a tendon without tension; see `limp`."""
    return slack_state(s, load_position(times, course, k, t, boundary, law), law)


@kernel
def slack_state(s: Floats, load: float, law: LugreLaws) -> Floats:
    """Return a tendon straight but without tension up to the load's place, shape (2, n + 2)."""
    start = np.zeros((2, law.n + 2))
    start[0, law.n + 1] = load
    for j in range(law.n, -1, -1):
        start[0, j] = start[0, j + 1] - law.preload_N / s[STIFFNESS + j]
    return start
