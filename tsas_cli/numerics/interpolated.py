"""Which samples of a channel were not recorded, but interpolated linearly between recorded ones.

Resampling a slow channel onto a faster clock does that, as `tsas ingest` with `resample`. Such
samples have no noise of their own: counted in, a channel seems four times less noisy than it is,
and its residual several times the noise level that it is.
"""

import numpy as np

from tsas_cli.support.arrays import Floats, Mask

MOST_RATIO = 50  # of the clock's rate to that of the recorded samples
STRAIGHT = 0.03  # second difference, over its RMS, that rounding in a file may leave
KINKED = 0.5  # share of the recorded samples that have to be off the line of their neighbours
FEWEST = 16  # recorded samples, so that it is not chance


def interpolated(values: Floats) -> Mask:
    """Return which samples are interpolated, shape (n,); none where that is uncertain.

    The channel has to be straight except at every second, third … sample of an even clock.
    """
    none = np.zeros(values.size, dtype=np.bool_)
    if values.size < 3 or not np.isfinite(values).all():
        return none
    bend = np.abs(np.diff(values, 2))
    kinks = np.flatnonzero(bend > STRAIGHT * np.sqrt(np.mean(bend**2))) + 1
    if kinks.size < KINKED * FEWEST:
        return none
    ratio = int(np.gcd.reduce(np.diff(kinks)))
    recorded = np.arange(kinks[0] % ratio, values.size, ratio)
    if not 1 < ratio <= MOST_RATIO or kinks.size < KINKED * max(recorded.size, FEWEST):
        return none
    between = ~none
    between[recorded] = False
    between[[0, -1]] = False  # no recorded sample bounds them
    return between
