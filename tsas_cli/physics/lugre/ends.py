"""Both ends of the tendon after a step of the dynamic chain, and what samples within it read."""

from typing import NamedTuple

from tsas_cli.effects.load_friction import guide_friction
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.lugre.input import DRIVE, LOAD, hermite
from tsas_cli.physics.lugre.state import (
    FRICTION,
    POSITION_HISTORY,
    POSITION_NEW,
    RATE,
    STIFFNESS,
    TENSION,
    Floats,
    LugreLaws,
    Step,
)

X_IN, X_OUT, F_IN, F_OUT = 0, 1, 2, 3  # rows of the columns


class StepEnds(NamedTuple):
    """Both ends of the tendon at the end of a step, with rates for what is read in between."""

    drive: float  # what is given there [mm or N]
    drive_rate: float
    load: float  # likewise
    load_rate: float
    x_in: float  # relative to the drive [mm]
    w_in: float
    x_out: float  # [mm]
    v_out: float
    f_in: float  # tension [N]
    f_in_rate: float
    f_out: float
    f_out_rate: float
    guide: float  # friction of the load's guide [N]


@kernel
def ends_after(s: Floats, step: Step, law: LugreLaws) -> StepEnds:
    """Return what the ends are after a step; positions go to Y_NEW."""
    n, last = law.n, law.n + 1
    for i in range(n + 2):
        s[POSITION_NEW + i] = s[POSITION_HISTORY + i] + step.gh * s[RATE + i]
    return StepEnds(
        step.drive,
        step.drive_rate,
        step.load,
        step.load_rate,
        s[POSITION_NEW],
        s[RATE],
        s[POSITION_NEW + last] + step.position,
        s[RATE + last] + step.speed,
        s[TENSION],
        s[STIFFNESS] * (s[RATE] - s[RATE + 1]),
        s[TENSION + n],
        s[STIFFNESS + n] * (s[RATE + n] - s[RATE + last]),
        s[FRICTION + last],
    )


@kernel
def interpolation_error(
    times: Floats,
    course: Floats,
    row: int,
    k: int,
    k1: int,
    t: float,
    h: float,
    ends: tuple[float, float, float, float],
) -> float:
    """Return by how much samples of a row leave the cubic that a step sees.

    The cubic has these values and rates at the ends of the step, k and k1 are the samples at or
    before them; three samples in between are looked at.
    """
    largest = 0.0
    if k1 - k > 1:
        for quarter in range(1, 4):
            i = k + 1 + quarter * (k1 - k - 1) // 4
            seen = hermite((times[i] - t) / h, h, ends[0], ends[1], ends[2], ends[3])
            largest = max(largest, abs(course[row, i] - seen))
    return largest


@kernel
def input_error(
    times: Floats,
    course: Floats,
    k: int,
    k1: int,
    t: float,
    h: float,
    ends: StepEnds,
    step: Step,
    answers: tuple[float, float],
    boundary: Boundary,
) -> float:
    """Return what a step does not see of drive and load, as tensions by how they answer [N]."""
    given = (ends.drive, ends.drive_rate, step.drive, step.drive_rate)
    off = answers[0] * interpolation_error(times, course, DRIVE, k, k1, t, h, given)
    if boundary.load != SPRING:
        given = (ends.load, ends.load_rate, step.load, step.load_rate)
        off += answers[1] * interpolation_error(times, course, LOAD, k, k1, t, h, given)
    return off


@kernel
def end_stiffnesses(earlier: StepEnds, ends: StepEnds, least: float) -> tuple[float, float]:
    """Return how much both tensions changed for what is given at their ends, at least so much."""
    return (
        secant_stiffness(ends.f_in - earlier.f_in, ends.drive - earlier.drive, least),
        secant_stiffness(ends.f_out - earlier.f_out, ends.load - earlier.load, least),
    )


@kernel
def secant_stiffness(tension: float, given: float, least: float) -> float:
    """Return how much a tension changed for what is given at its end, at least so much."""
    return max(abs(tension / given), least) if given != 0.0 else least


@kernel
def write_samples(
    columns: Floats,
    first: int,
    end: int,
    times: Floats,
    course: Floats,
    t: float,
    h: float,
    a: StepEnds,
    b: StepEnds,
    boundary: Boundary,
    law: LugreLaws,
) -> None:
    """Write what the ends are at the samples from the first to before the end.

    They lie in the step h from a to b that begins at t.
    """
    write_cubic(columns, X_OUT, first, end, times, t, h, (a.x_out, a.v_out, b.x_out, b.v_out))
    if boundary.drive == FORCE:
        write_cubic(columns, X_IN, first, end, times, t, h, (a.x_in, a.w_in, b.x_in, b.w_in))
    else:
        write_cubic(
            columns, F_IN, first, end, times, t, h, (a.f_in, a.f_in_rate, b.f_in, b.f_in_rate)
        )
    if boundary.load != FORCE:
        write_cubic(
            columns, F_OUT, first, end, times, t, h, (a.f_out, a.f_out_rate, b.f_out, b.f_out_rate)
        )
    share = sensor_share(boundary, law)
    for i in range(first, end):
        columns[F_IN if boundary.drive == FORCE else X_IN, i] = course[DRIVE, i]
        if boundary.load != SPRING:
            columns[F_OUT if boundary.load == FORCE else X_OUT, i] = course[LOAD, i]
        if boundary.load != FORCE and share > 0.0:
            guide = a.guide + (times[i] - t) / h * (b.guide - a.guide)
            columns[F_OUT, i] -= share * guide


@kernel
def write_cubic(
    columns: Floats,
    row: int,
    first: int,
    end: int,
    times: Floats,
    t: float,
    h: float,
    ends: tuple[float, float, float, float],
) -> None:
    """Write the cubic through value and slope at both ends of a step at the samples within it."""
    x0, v0, x1, v1 = ends
    rise, inverse = (x1 - x0) / h, 1.0 / h
    square, cube = (3.0 * rise - 2.0 * v0 - v1) * inverse, (v0 + v1 - 2.0 * rise) * inverse**2
    for i in range(first, end):
        since = times[i] - t
        columns[row, i] = x0 + since * (v0 + since * (square + since * cube))


@kernel
def sensor_share(boundary: Boundary, law: LugreLaws) -> float:
    """Return the share of the guide's friction that the load's force sensor does not feel."""
    before = law.load_friction.before_sensor_N
    if before == 0.0:
        return 0.0
    if boundary.load == DISPLACEMENT:
        return 1.0
    return before / guide_friction(law.load_friction)
