"""Which samples of a channel were not recorded, but laid on straight lines between those that were.

Whoever brings a slow channel onto a faster clock does that, `tsas ingest` with `resample` among
them. Such samples hold no noise of their own: counted in, a channel seems four times less noisy
than it is, and its errors several times as many as they are.
"""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

MOST_TIMES = 50  # as fast as it was recorded
STRAIGHT = 0.03  # bend at a sample, of the usual one, that rounding in a file may leave
KINKED = 0.5  # of the samples that were recorded, that have to be off the line of their neighbours
FEWEST = 16  # recorded samples, so that it is no chance


def interpolated(values: Floats) -> Mask:
    """Return which samples lie between recorded ones, shape (n,); none where that is not sure.

    The channel has to be straight but at every second, third … sample, counted on an even clock.
    """
    nothing = np.zeros(values.size, dtype=np.bool_)
    if values.size < 3 or not np.isfinite(values).all():
        return nothing
    bend = np.abs(np.diff(values, 2))
    kinks = np.flatnonzero(bend > STRAIGHT * np.sqrt(np.mean(bend**2))) + 1
    if kinks.size < KINKED * FEWEST:
        return nothing
    times = int(np.gcd.reduce(np.diff(kinks)))
    recorded = np.arange(kinks[0] % times, values.size, times)
    if not 1 < times <= MOST_TIMES or kinks.size < KINKED * max(recorded.size, FEWEST):
        return nothing
    between = ~nothing
    between[recorded] = False
    between[[0, -1]] = False  # a piece that no recorded sample ends
    return between
