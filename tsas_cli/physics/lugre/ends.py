"""Both ends of the tendon after a step of the dynamic chain, and the samples within it."""

from typing import NamedTuple

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, share_before_sensor
from tsas_cli.physics.course import DRIVE, LOAD, TIME
from tsas_cli.physics.lugre import state as at
from tsas_cli.physics.lugre.input import Cubic, hermite
from tsas_cli.physics.lugre.state import Given, LugreLaws, Step
from tsas_cli.support.arrays import Floats

X_IN, X_OUT, F_IN, F_OUT = range(4)  # rows of the columns


class EndState(NamedTuple):
    """One end of the tendon at the end of a step, with rates for interpolation."""

    given: Given
    x: float  # at the drive relative to it [mm]
    v: float
    tension: float  # [N]
    tension_rate: float


class StepEnds(NamedTuple):
    """Both ends of the tendon at the end of a step."""

    drive: EndState
    load: EndState
    guide: float  # friction of the load's guide [N]


class Span(NamedTuple):
    """A step in time: from t, h long [s]."""

    t: float
    h: float


class Samples(NamedTuple):
    """The samples first … end−1."""

    first: int
    end: int


@kernel
def ends_after(s: Floats, step: Step, laws: LugreLaws) -> StepEnds:
    """Return the ends after a step; write the nodes' positions to POSITION_NEW."""
    n, last = laws.n, laws.n + 1
    for i in range(n + 2):
        s[at.POSITION_NEW + i] = s[at.POSITION_HISTORY + i] + step.gh * s[at.RATE + i]
    drive = EndState(
        step.drive,
        s[at.POSITION_NEW],
        s[at.RATE],
        s[at.TENSION],
        s[at.STIFFNESS] * (s[at.RATE] - s[at.RATE + 1]),
    )
    load = EndState(
        step.load,
        s[at.POSITION_NEW + last] + step.frame.value,
        s[at.RATE + last] + step.frame.rate,
        s[at.TENSION + n],
        s[at.STIFFNESS + n] * (s[at.RATE + n] - s[at.RATE + last]),
    )
    return StepEnds(drive, load, s[at.FRICTION + last])


@kernel
def interpolation_error(
    course: Floats, row: int, within: Samples, span: Span, given: Cubic
) -> float:
    """Return the largest deviation of an input from the cubic of a step, at three samples."""
    largest, count = 0.0, within.end - within.first
    if count > 0:
        for quarter in range(1, 4):
            i = within.first + quarter * count // 4
            interpolated = hermite((course[TIME, i] - span.t) / span.h, span.h, given)
            largest = max(largest, abs(course[row, i] - interpolated))
    return largest


@kernel
def input_error(
    course: Floats,
    within: Samples,
    span: Span,
    ends: StepEnds,
    step: Step,
    stiffness: tuple[float, float],
    laws: LugreLaws,
) -> float:
    """Return the interpolation error of drive and load, as a tension by the ends' stiffness [N]."""
    drive = between(ends.drive.given, step.drive)
    error_N = stiffness[0] * interpolation_error(course, DRIVE, within, span, drive)
    if laws.load.given != SPRING:
        load = between(ends.load.given, step.load)
        error_N += stiffness[1] * interpolation_error(course, LOAD, within, span, load)
    return error_N


@kernel
def between(a: Given, b: Given) -> Cubic:
    """Return the cubic of a given quantity over a step."""
    return Cubic(a.value, a.rate, b.value, b.rate)


@kernel
def end_stiffnesses(earlier: StepEnds, ends: StepEnds, least: float) -> tuple[float, float]:
    """Return the change of both tensions over that of the given quantities, at least `least`."""
    return (
        secant_stiffness(earlier.drive, ends.drive, least),
        secant_stiffness(earlier.load, ends.load, least),
    )


@kernel
def secant_stiffness(earlier: EndState, end: EndState, least: float) -> float:
    """Return the change of a tension over that of the given quantity, at least `least`."""
    given = end.given.value - earlier.given.value
    return max(abs((end.tension - earlier.tension) / given), least) if given != 0.0 else least


@kernel
def write_samples(
    columns: Floats,
    within: Samples,
    course: Floats,
    span: Span,
    a: StepEnds,
    b: StepEnds,
    laws: LugreLaws,
) -> None:
    """Write the columns at the samples within the step from a to b."""
    x_out = Cubic(a.load.x, a.load.v, b.load.x, b.load.v)
    write_cubic(columns, X_OUT, within, course, span, x_out)
    if laws.drive.given == FORCE:
        x_in = Cubic(a.drive.x, a.drive.v, b.drive.x, b.drive.v)
        write_cubic(columns, X_IN, within, course, span, x_in)
    else:
        write_cubic(columns, F_IN, within, course, span, tension_between(a.drive, b.drive))
    if laws.load.given != FORCE:
        write_cubic(columns, F_OUT, within, course, span, tension_between(a.load, b.load))
    write_given(columns, within, course, laws)
    share = share_before_sensor(laws.load)
    if laws.load.given != FORCE and share > 0.0:
        for i in range(within.first, within.end):
            guide = a.guide + (course[TIME, i] - span.t) / span.h * (b.guide - a.guide)
            columns[F_OUT, i] -= share * guide


@kernel
def write_given(columns: Floats, within: Samples, course: Floats, laws: LugreLaws) -> None:
    """Write the columns that are given at the ends."""
    for i in range(within.first, within.end):
        if laws.drive.given == FORCE:
            columns[F_IN, i] = course[DRIVE, i]
        else:
            columns[X_IN, i] = course[DRIVE, i]
        if laws.load.given == FORCE:
            columns[F_OUT, i] = course[LOAD, i]
        elif laws.load.given != SPRING:
            columns[X_OUT, i] = course[LOAD, i]


@kernel
def tension_between(a: EndState, b: EndState) -> Cubic:
    """Return the cubic of the tension at an end over a step."""
    return Cubic(a.tension, a.tension_rate, b.tension, b.tension_rate)


@kernel
def write_cubic(
    columns: Floats, row: int, within: Samples, course: Floats, span: Span, ends: Cubic
) -> None:
    """Write a cubic over a step at the samples within it."""
    x0, v0, x1, v1 = ends
    rise, inverse = (x1 - x0) / span.h, 1.0 / span.h
    square, cube = (3.0 * rise - 2.0 * v0 - v1) * inverse, (v0 + v1 - 2.0 * rise) * inverse**2
    for i in range(within.first, within.end):
        since = course[TIME, i] - span.t
        columns[row, i] = x0 + since * (v0 + since * (square + since * cube))
