"""How the measured course of a driven end may be wrong: advanced, or reversed unseen at a rest."""

from itertools import pairwise

import numpy as np

from tsas_cli.numerics.conditioning import Conditioned
from tsas_cli.support.arrays import Floats

REVERSAL_SD = 3.0  # error of the position of a reversal, in standard deviations


def reversed_at_rest(conditioned: Conditioned, time_s: Floats) -> Floats:
    """Return the values with every other sample moved back where the drive hardly moves.

    There it may have reversed unseen, by an error or by a quantisation step, as a drive does whose
    controller hunts. Friction along the sheath makes of a micrometre a large part of the loop.
    """
    x = conditioned.values
    samples = max(round(0.5 * conditioned.window_s / float(np.median(np.diff(time_s)))), 1)
    padded = np.pad(x, samples, mode="edge")
    moved = np.minimum(np.abs(padded[2 * samples :] - x), np.abs(x - padded[: -2 * samples]))
    rests = moved < np.maximum(REVERSAL_SD * conditioned.sd, conditioned.step)
    back = np.where(rests, np.maximum(conditioned.sd, conditioned.step), 0.0)
    back[::2] = 0.0
    for first, end in pairwise(conditioned.reversals):
        back[first + 1 : end + 1] *= 1.0 if x[end] >= x[first] else -1.0
    return np.asarray(x - back)


def beside(change: Floats) -> Floats:
    """Return the larger change of every other sample and its neighbours."""
    size = np.pad(np.abs(change), 1)
    return np.asarray(np.maximum(size[1:-1], np.maximum(size[:-2], size[2:])))


def advanced(conditioned: Conditioned) -> Floats:
    """Return the values with each stroke advanced by one standard deviation."""
    moved = conditioned.values.copy()
    for first, end in pairwise(conditioned.reversals):
        up = conditioned.values[end] >= conditioned.values[first]
        part = slice(
            first + 1 if first else 0, end + 1
        )  # a reversal belongs to the stroke that it ends
        moved[part] = conditioned.values[part] + conditioned.sd[part] * (1.0 if up else -1.0)
    return moved
