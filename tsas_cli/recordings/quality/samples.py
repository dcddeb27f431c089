"""Properties of the samples of one channel: quantisation, noise, plateaus."""

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.noise import quantisation_step
from tsas_cli.support.arrays import Floats

_FEWEST = 16  # samples for an estimate of the noise


def step_of(values: Floats) -> float:
    """Return the quantisation step, 0 without quantisation.

    A channel that seldom repeats a level shows its step in the increments.
    """
    increments = np.round(np.diff(values), 12)
    return quantisation_step(values) or quantisation_step(increments)


def span_of(values: Floats) -> float:
    """Return the span of a channel, without the outermost thousandth at either end."""
    return float(np.ptp(np.nanpercentile(values, (0.1, 99.9))))


def alternates(values: Floats) -> bool:
    """Return whether a channel, shape (n,), is noisy.

    Third differences alternate for noise, not for motion.
    """
    clean = values[np.isfinite(values)]
    third = np.diff(clean, 3)
    third = third[np.abs(third) > 1e-9 * np.abs(clean).max(initial=0.0)]
    return third.size >= _FEWEST and bool(np.mean(third[1:] * third[:-1] < 0.0) > 0.5)


def rows_between_changes(values: Floats) -> npt.NDArray[np.int64]:
    """Return the number of rows from each change of a channel to the next."""
    return np.diff(np.flatnonzero(values[1:] != values[:-1]))


def smallest_change(values: Floats) -> float:
    """Return the smallest change from row to row beyond rounding; infinite without a change."""
    change = np.abs(np.diff(values))
    rounding = 1e-9 * np.nanmax(np.abs(values))
    return float(np.min(change, where=change > rounding, initial=np.inf))


def plateaus(values: Floats, shortest: int) -> list[slice]:
    """Return the stretches of at least `shortest` rows in which a channel, shape (n,), is constant.

    NaN belongs to no stretch.
    """
    changes = np.flatnonzero(values[1:] != values[:-1]) + 1
    edges = np.concatenate(([0], changes, [values.size]))
    long = np.flatnonzero(np.diff(edges) >= shortest)
    return [slice(int(edges[i]), int(edges[i + 1])) for i in long]
