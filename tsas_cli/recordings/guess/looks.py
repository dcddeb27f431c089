"""Properties of signals: an even clock, a sign, the order of two channels along the tendon.

Friction along the sheath delays the distal channels: at the same proximal displacement, the
proximal tension is higher during contraction, and distal displacement and tension are lower. The
hysteresis loop of two channels therefore shows which of them is nearer to the drive. A delay of a
filter makes a loop too, but of a width in proportion to the speed; this part is fitted separately.
"""

from itertools import pairwise

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.support.arrays import Floats

_FEWEST = 64  # samples
_ROWS = 50_000  # of a longer run that are used, evenly spread
_CORRELATED = 0.5  # least correlation of two channels that are ordered
_NARROW = 0.001  # of the span: largest half width of no loop
_CONSISTENT = 0.2  # least ratio of the narrowest loop to the widest
_INDEPENDENT = 0.005  # least share of the speed that the other terms leave unexplained
_AMBIGUOUS = 0.02  # of the span: half width up to which a delay and friction are confounded
_MOVING = (0.15, 0.97)  # of a stroke: beyond the dead band, before the drive slows down


def increases(values: Floats) -> bool:
    """Return whether values increase strictly, without a gap."""
    return values.size > 1 and bool(np.isfinite(values).all() and (np.diff(values) > 0.0).all())


def is_even(values: Floats) -> bool:
    """Return whether increasing values have even steps, except a few lost samples."""
    steps = np.diff(values)
    typical = float(np.median(steps))
    return bool(np.mean(np.abs(steps - typical) < 0.5 * typical) > 0.95)


def sign_of(values: Floats) -> int:
    """Return 1 or −1 if (almost) all values have this sign, else 0."""
    low, high = np.nanpercentile(values, (2.0, 98.0))
    return 1 if low > 0.0 else -1 if high < 0.0 else 0


def correlation(a: Floats, b: Floats) -> float:
    """Return the correlation coefficient of two channels, 0 if one of them is constant."""
    valid = np.isfinite(a) & np.isfinite(b)
    a, b = a[valid], b[valid]
    if a.size < _FEWEST or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    with np.errstate(all="ignore"):  # 1e300 marks a gap in some files
        found = float(np.corrcoef(a, b)[0, 1])
    return found if np.isfinite(found) else 0.0


def leads(a: Floats, b: Floats) -> int:
    """Return 1 if `a` is nearer to the drive than `b`, −1 if farther, 0 if it is undecided.

    Both are channels of one run, shape (n,), of any unit and sign.
    """
    over = lag(a, b), lag(b, a)
    if over[0] is None or over[1] is None or over[0] * over[1] >= 0.0:
        return 0
    return 1 if over[0] > 0.0 else -1


def lag(over: Floats, values: Floats) -> float | None:
    """Return the lag of `values` behind `over`: half the loop's width over its span.

    Negative if it leads; None if the channels are not correlated, the motion has fewer than two
    strokes, or the strokes are inconsistent.
    """
    valid = np.isfinite(over) & np.isfinite(values)
    every = over.size // _ROWS + 1
    u, v = over[valid][::every], values[valid][::every]
    if u.size < _FEWEST or abs(correlation(u, v)) < _CORRELATED:
        return None
    v = v * np.sign(correlation(u, v))
    span = float(np.ptp(np.percentile(u, (0.5, 99.5))))
    reversals = turning_points(np.ascontiguousarray(u), max(0.2 * span, 6.0 * noise_sd(u)))
    widths = [
        _width(u, v, *rows) for rows in zip(reversals, reversals[1:], reversals[2:], strict=False)
    ]
    halves = np.array([w for w in widths if w is not None])
    if halves.size == 0 or halves.min() * halves.max() <= 0.0:
        return None
    if np.abs(halves).min() < _CONSISTENT * np.abs(halves).max():
        return None
    mean = float(halves.mean()) / float(np.ptp(np.percentile(v, (0.5, 99.5))))
    return -mean if abs(mean) > _NARROW else None


def _width(u: Floats, v: Floats, start: int, reversal: int, stop: int) -> float | None:
    """Return h of v = a + b u + c u² + h · direction + e · speed over two strokes.

    None if a stroke has too few samples, or if the speed is so constant that delay and friction are
    indistinguishable and the loop is no wider than a delay makes it.
    """
    rows = np.arange(start, stop + 1)
    direction = np.zeros(rows.size)
    for first, last in pairwise((start, reversal, stop)):
        if last - first < _FEWEST // 4 or u[last] == u[first]:
            return None
        share = (u[first : last + 1] - u[first]) / (u[last] - u[first])
        sign = np.sign(u[last] - u[first])
        moving = (share > _MOVING[0]) & (share < _MOVING[1])
        direction[first - start : last + 1 - start] = np.where(moving, sign, 0.0)
    width = max(min(reversal - start, stop - reversal) // 20, 1)
    speed = np.gradient(np.convolve(np.pad(u[rows], width, mode="edge"), np.ones(width), "same"))
    used = direction != 0.0
    if np.count_nonzero(used) < _FEWEST // 4:
        return None
    x, y = u[rows][used], v[rows][used]
    x = (x - x.mean()) / (np.std(x) or 1.0)
    terms = np.column_stack([np.ones_like(x), x, x**2, direction[used]])
    fast = speed[width:-width][used]
    own = fast - terms @ np.linalg.lstsq(terms, fast, rcond=None)[0]
    if np.sum(own**2) > _INDEPENDENT * np.sum(fast**2):
        return float(np.linalg.lstsq(np.column_stack([terms, fast]), y, rcond=None)[0][3])
    half = float(np.linalg.lstsq(terms, y, rcond=None)[0][3])
    return half if abs(half) > _AMBIGUOUS * float(np.ptp(v)) else None
