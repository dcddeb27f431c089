"""When to look at a tendon: evenly in time, and densely where its tensions change fast."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

PER_SECOND = 15.0
PER_SPAN = 120.0  # while a tension goes through all that it has in the run: half a dead band of
#   the source paper's rig then takes about thirty
MOST = 1500  # of one run, whatever its length, and as many turns


def moments(time_s: Floats, tensions: Sequence[Floats], turns: Indices) -> Indices:
    """Return the samples to look at, rising, the turns, the first and the last one among them.

    Parameters
    ----------
    time_s
        Time of the samples, shape (n,).
    tensions
        What must not jump from one to the next: tensions of all models shown, shape (n,) each.
    turns
        Samples at which the drive turns, shape (p,).
    """
    steps = PER_SECOND * np.diff(time_s)
    for tension in tensions:
        there = tension[np.isfinite(tension)]
        span = float(np.ptp(there)) if there.size else 0.0
        if span > 0.0:
            steps = np.fmax(steps, PER_SPAN / span * np.abs(np.diff(tension)))
    passed = np.concatenate(([0.0], np.cumsum(steps)))
    frames = np.searchsorted(passed, np.arange(0.0, passed[-1], max(1.0, passed[-1] / MOST)))
    some = turns[:: 1 + turns.size // MOST]
    return np.unique(np.concatenate((frames, some, [time_s.size - 1])).astype(np.int64))
