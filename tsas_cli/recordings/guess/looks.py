"""What signals show by themselves: an even clock, a sign, which of two goes ahead.

Friction along a sheath holds back whatever comes behind it: at the same place of the drive the
tension at the drive is higher while it pulls, and what is at the load is lower. So the loop of two
channels over one another says which of them is nearer to the drive. A late filter makes a loop
too, but one that is as wide as the motion is fast: its part is fitted beside.
"""

from itertools import pairwise

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.readers.table import Floats

_FEWEST = 64  # samples
_ROWS = 50_000  # of a longer run so many are looked at, evenly
_TOGETHER = 0.5  # the correlation below which two channels do not go together
_NARROW = 0.001  # of the span: half the width of a loop that is none
_ALIKE = 0.2  # the narrowest loop over the widest, below which the strokes do not agree
_ALONE = 0.005  # the share of the speed that the other terms must leave, else it is one of them
_LATE = 0.02  # of the span: half the width where a delay cannot be told from friction
_UNDER_WAY = (0.15, 0.97)  # of a stroke: beyond the dead band, before the drive slows down


def increases(values: Floats) -> bool:
    """Say whether values increase strictly, without a gap."""
    return values.size > 1 and bool(np.isfinite(values).all() and (np.diff(values) > 0.0).all())


def is_even(values: Floats) -> bool:
    """Say whether increasing values do so in steps of one size, a few lost samples apart."""
    steps = np.diff(values)
    typical = float(np.median(steps))
    return bool(np.mean(np.abs(steps - typical) < 0.5 * typical) > 0.95)


def sign_of(values: Floats) -> int:
    """Return 1 or −1 where (almost) all values are on that side of zero, else 0."""
    low, high = np.nanpercentile(values, (2.0, 98.0))
    return 1 if low > 0.0 else -1 if high < 0.0 else 0


def together(a: Floats, b: Floats) -> float:
    """Return the correlation of two channels, 0 where one of them rests."""
    there = np.isfinite(a) & np.isfinite(b)
    a, b = a[there], b[there]
    if a.size < _FEWEST or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    with np.errstate(over="ignore", invalid="ignore"):  # 1e300 stands for a gap in some files
        found = float(np.corrcoef(a, b)[0, 1])
    return found if np.isfinite(found) else 0.0


def goes_ahead(a: Floats, b: Floats) -> int:
    """Return 1 where `a` is nearer to the drive than `b`, −1 where farther, 0 where not told.

    Parameters
    ----------
    a, b
        Two channels of one run, shape (n,), of any unit and sign.
    """
    over = held_back(a, b), held_back(b, a)
    if over[0] is None or over[1] is None or over[0] * over[1] >= 0.0:
        return 0
    return 1 if over[0] > 0.0 else -1


def held_back(over: Floats, values: Floats) -> float | None:
    """Return how far `values` stays behind `over`: half its loop's width as a share of its span.

    Below zero where it goes ahead; None where the channels do not go together, the motion has no
    two strokes, or the strokes do not agree.
    """
    there = np.isfinite(over) & np.isfinite(values)
    every = over.size // _ROWS + 1
    u, v = over[there][::every], values[there][::every]
    if u.size < _FEWEST or abs(together(u, v)) < _TOGETHER:
        return None
    v = v * np.sign(together(u, v))
    span = float(np.ptp(np.percentile(u, (0.5, 99.5))))
    turns = turning_points(np.ascontiguousarray(u), max(0.2 * span, 6.0 * noise_sd(u)))
    widths = [_width(u, v, *rows) for rows in zip(turns, turns[1:], turns[2:], strict=False)]
    halves = np.array([w for w in widths if w is not None])
    if halves.size == 0 or halves.min() * halves.max() <= 0.0:
        return None
    if np.abs(halves).min() < _ALIKE * np.abs(halves).max():
        return None
    mean = float(halves.mean()) / float(np.ptp(np.percentile(v, (0.5, 99.5))))
    return -mean if abs(mean) > _NARROW else None


def _width(u: Floats, v: Floats, start: int, turn: int, stop: int) -> float | None:
    """Return h of v = a + b u + c u² + h · direction + e · speed over two strokes.

    None where a stroke has too few samples, or the loop is no wider than a delay makes it and the
    drive is so even that the two cannot be told apart.
    """
    rows = np.arange(start, stop + 1)
    direction = np.zeros(rows.size)
    for first, last in pairwise((start, turn, stop)):
        if last - first < _FEWEST // 4 or u[last] == u[first]:
            return None
        share = (u[first : last + 1] - u[first]) / (u[last] - u[first])
        way = np.sign(u[last] - u[first])
        under = (share > _UNDER_WAY[0]) & (share < _UNDER_WAY[1])
        direction[first - start : last + 1 - start] = np.where(under, way, 0.0)
    width = max(min(turn - start, stop - turn) // 20, 1)
    speed = np.gradient(np.convolve(np.pad(u[rows], width, mode="edge"), np.ones(width), "same"))
    kept = direction != 0.0
    x, y = u[rows][kept], v[rows][kept]
    x = (x - x.mean()) / (np.std(x) or 1.0)
    terms = np.column_stack([np.ones_like(x), x, x**2, direction[kept]])
    fast = speed[width:-width][kept]
    own = fast - terms @ np.linalg.lstsq(terms, fast, rcond=None)[0]
    if np.sum(own**2) > _ALONE * np.sum(fast**2):
        return float(np.linalg.lstsq(np.column_stack([terms, fast]), y, rcond=None)[0][3])
    half = float(np.linalg.lstsq(terms, y, rcond=None)[0][3])
    return half if abs(half) > _LATE * float(np.ptp(v)) else None
