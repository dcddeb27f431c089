"""Fewer points for a plot, the same picture."""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

POINTS = 2400  # a bin is then narrower than a pixel of a plot of 30 rem


def kept_samples(*series: Floats, points: int = POINTS) -> Indices:
    """Return the samples that a plot needs: the extremes of every series in each of equal bins.

    The first and the last sample are always kept, the last bin may be shorter than the others,
    and a bin without any number keeps one sample, so that a gap stays a gap.

    Parameters
    ----------
    series
        One or more channels over the same samples, shape (n,) each, NaN for gaps.
    points
        About how many samples to keep.
    """
    n = series[0].size
    if n <= points:
        return np.arange(n)
    width = -(-n * 2 * len(series) // points)
    starts = np.arange(0, n, width)
    kept = [np.array([0, n - 1])]
    for values in series:
        padded = np.full(starts.size * width, np.nan)
        padded[:n] = values
        bins = padded.reshape(-1, width)
        missing = np.isnan(bins)
        kept.append(starts + np.where(missing, np.inf, bins).argmin(axis=1))
        kept.append(starts + np.where(missing, -np.inf, bins).argmax(axis=1))
    return np.unique(np.concatenate(kept))
