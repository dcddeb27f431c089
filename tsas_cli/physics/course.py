"""Inputs of the tendon over a run, sample by sample, and outputs of a model.

A course is one array, shape (11, m), because a compiled call counts the references of each array
argument: with a record of rows the dynamic chain takes a quarter longer.
"""

from typing import NamedTuple

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.phases import Phases
from tsas_cli.support.arrays import Floats

# Rows of a course; the first four alone are a course of `Losses`.
PULLED, RELEASED, DRAG, LOST = range(4)
DRIVE, LOAD = 4, 5  # displacement [mm] or tension at the sensor [N]; LOAD unused with a spring
STEP = 6  # time since the sample before, infinite for a quasi-static step [s]
TIME = 7  # since the start of the run [s]
# For the force beside the tendon at the drive; a solver reads no row from here on.
DIRECTION = 8  # of the last motion of the tendon's end at the drive
TRAVEL = 9  # of that end since its last reversal, infinite before the first one [mm]
MOTION = 10  # force at the drive's sensor for the motion of that end [N]


class Losses(NamedTuple):
    """Losses of tension along the sheath and of preload at the load's anchor, at one moment."""

    pulled: float  # friction times bend in contraction [1]
    released: float  # friction times bend in loosening [1]
    drag_N: float  # tension lost over the whole sheath to friction independent of the tension
    preload_N: float  # lost at the load spring's anchor


class Tensions(NamedTuple):
    """Output of a closed-form model; with a spring load the positions follow. See `Output`."""

    f_in: Floats
    f_out: Floats
    phase: Phases


class Output(NamedTuple):
    """Output of a model at each sample, without the sensors' errors, shape (m,) [mm, N].

    `phase` is +1 where the whole tendon slips in contraction, −1 in loosening, 0 where a part of
    it sticks, 2 where it is slack, 3 where the solver did not converge.
    """

    x_in: Floats
    x_out: Floats
    f_in: Floats
    f_out: Floats
    phase: Phases


def samples_of(output: Output, within: slice) -> Output:
    """Return some samples of an output."""
    return Output._make(values[within] for values in output)


@kernel
def losses_of(course: Floats, i: int) -> Losses:
    """Return the losses at one sample."""
    return Losses(course[PULLED, i], course[RELEASED, i], course[DRAG, i], course[LOST, i])


@kernel
def with_friction(losses: Losses, factor: float) -> Losses:
    """Return the losses with the friction coefficient times a factor."""
    pulled, released = losses.pulled * factor, losses.released * factor
    return Losses(pulled, released, losses.drag_N, losses.preload_N)


@kernel
def losses_between(start: Losses, end: Losses, part: float) -> Losses:
    """Return the losses interpolated linearly between two moments, `part` from 0 to 1."""
    return Losses(
        start.pulled + part * (end.pulled - start.pulled),
        start.released + part * (end.released - start.released),
        start.drag_N + part * (end.drag_N - start.drag_N),
        start.preload_N + part * (end.preload_N - start.preload_N),
    )
