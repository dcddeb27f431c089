"""What every solver is asked for, and what is seen of what it gives."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from benchmarks.lugre_rivals.drives import Floats
from benchmarks.lugre_rivals.ode import Output, Problem, output


class NotAvailableError(Exception):
    """A solver is not installed; the text says what is missing."""


class Tolerance(NamedTuple):
    """What a step may miss each part of the state by; `relative` is of the part's value."""

    y_mm: float
    w_mm_s: float
    z_mm: float
    relative: float = 0.0

    def absolute(self, lumps: int) -> Floats:
        """Return the absolute tolerances of a whole state."""
        return np.append(np.tile([self.y_mm, self.w_mm_s, self.z_mm], lumps), self.y_mm)


def at_times(problem: Problem, states: Floats) -> Output:
    """Return what is seen, given the states at the problem's times."""
    return output(problem, states[:, 0], states[:, 1], states[:, -1])


def joined(problem: Problem, time_s: Floats, states: Floats) -> Output:
    """Return what is seen, given the states at a solver's own steps, joined by cubics.

    The state holds the slope of y; that of the load end follows from its equation.
    """
    p = problem.model.constants()
    k, c, kL = p.stiffness_N_per_mm, p.damping_N_s_per_mm, p.load_stiffness_N_per_mm
    y, w, y_load = states[:, 0], states[:, 1], states[:, -1]
    stretch = states[:, -4] - y_load
    load = kL * (y_load + problem.drive.position(time_s))
    w_load = states[:, -3] + (2.0 * k * stretch - load) / (2.0 * c)
    at_drive = CubicHermiteSpline(time_s, y, w)
    at_load = CubicHermiteSpline(time_s, y_load, w_load)
    wanted = problem.time_s
    return output(problem, at_drive(wanted), at_drive(wanted, 1), at_load(wanted))
