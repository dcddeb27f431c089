"""What acts on a tendon over a run, sample by sample, and what a model gives for it.

A course is one array, shape (8, m), because a compiled call counts the references of each array
that it gets: with a record of rows the dynamic chain takes a quarter longer.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.phases import Phases

Floats = npt.NDArray[np.float64]

# Rows of a course; the first four alone are a course of `Losses`.
PULLED, RELEASED, VISCOUS, LOST = range(4)
DRIVE, LOAD = 4, 5  # displacement [mm] or tension at the sensor [N]; a spring gives no load
STEP = 6  # time since the sample before, infinite where it plays no part [s]
TIME = 7  # since the run began [s]


class Losses(NamedTuple):
    """What the tendon loses along the sheath and at the load's anchor, at one moment."""

    pulled: float  # friction times bend in contraction [1]
    released: float  # friction times bend in loosening [1]
    viscous_N: float  # tension lost over the whole sheath to viscous friction
    preload_N: float  # that the load spring's anchor has lost


class Tensions(NamedTuple):
    """What a model in closed form gives: with a spring load the rest follows. See `Output`."""

    f_in: Floats
    f_out: Floats
    phase: Phases


class Output(NamedTuple):
    """What a model gives at each sample, free of the sensors' errors, shape (m,) [mm, N].

    `phase` is +1 where the whole tendon slips in contraction, −1 in loosening, 0 where a part of
    it sticks, 2 where it hangs slack, 3 where the solver did not converge.
    """

    x_in: Floats
    x_out: Floats
    f_in: Floats
    f_out: Floats
    phase: Phases


@kernel
def losses_of(course: Floats, i: int) -> Losses:
    """Return the losses at one sample."""
    return Losses(course[PULLED, i], course[RELEASED, i], course[VISCOUS, i], course[LOST, i])


@kernel
def losses_between(start: Losses, end: Losses, part: float) -> Losses:
    """Return the losses at a part of the straight way from one moment to another."""
    return Losses(
        start.pulled + part * (end.pulled - start.pulled),
        start.released + part * (end.released - start.released),
        start.viscous_N + part * (end.viscous_N - start.viscous_N),
        start.preload_N + part * (end.preload_N - start.preload_N),
    )
