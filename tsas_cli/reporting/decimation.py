"""Fewer points for a plot, the same picture."""

import numpy as np

from tsas_cli.support.arrays import Floats, Indices

POINTS = 2400  # a bin is then narrower than a pixel of a plot of 30 rem
FEWEST = 200
CELLS = 300  # across and down a plot of half that width


def kept_samples(*series: Floats, points: int = POINTS) -> Indices:
    """Return the samples that a plot needs: the extremes of every series in each of equal bins.

    The first and the last sample are always kept, the last bin may be shorter than the others,
    and a bin without any number keeps one sample, so that a gap stays a gap.

    `series` are channels over the same samples, shape (n,) each, NaN for gaps; about `points`
    samples are kept.
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


def shared_points(curves: int, total: int) -> int:
    """Return about how many points each of so many curves may have, so that a page stays small.

    >>> shared_points(3, 30_000), shared_points(30, 30_000), shared_points(3000, 30_000)
    (2400, 1000, 200)
    """
    return min(max(total // max(curves, 1), FEWEST), POINTS)


def kept_cells(x: Floats, y: Floats, *, cells: int = CELLS) -> Indices:
    """Return the samples at which a curve in a plane enters another cell of an even grid.

    A curve that hurries here and waits there keeps its shape everywhere, to within a cell.

    `x` and `y` have shape (n,), without gaps; `cells` is how many there are along each axis of the
    curve's own range.
    """
    places = [_cells(values, cells) for values in (x, y)]
    enters = (np.diff(places[0]) != 0) | (np.diff(places[1]) != 0)
    return np.unique(np.concatenate(([0], np.flatnonzero(enters) + 1, [x.size - 1])))


def _cells(values: Floats, cells: int) -> Indices:
    span = float(np.ptp(values)) or 1.0
    places: Indices = np.floor((values - values.min()) / span * cells).astype(np.int64)
    return places
