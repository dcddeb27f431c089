"""How things change over the time of a run."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats

Course = tuple[tuple[float, float], ...]
ONE: Course = ((0.0, 1.0),)


def course(points: Course, t: Floats) -> Floats:
    """Return (position, value) pairs at t: linear in between, constant outside."""
    at, value = np.array(points, dtype=float).T
    return np.asarray(np.interp(t, at, value))


def settled(rate: float, settling_per_s: float, t: Floats) -> Floats:
    """Return what a change has come to that begins at `rate` and slows down exponentially.

    The integral of rate · exp(−settling_per_s · t) from 0 to t; settling_per_s = 0 goes on evenly.
    """
    if settling_per_s == 0.0:
        return np.asarray(rate * t)
    return np.asarray(-rate * np.expm1(-settling_per_s * t) / settling_per_s)
