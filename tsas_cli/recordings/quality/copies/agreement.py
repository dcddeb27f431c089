"""Which samples of a run lie on another run's samples, or on the line through them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]

BESIDE = 32  # rows on either side, after which a spline has forgotten its end
HERE = 1e-6  # of a sample, which the times of a copy are rounded by
STEPS = 8  # of Gauss and Newton, from within a sample


@dataclass(frozen=True, eq=False)
class Samples:
    """Times, shape (n,) and strictly increasing, and values of some channels, shape (n, d)."""

    time_s: Floats
    values: Floats

    def part(self, rows: slice) -> "Samples":
        """Return some of the rows."""
        return Samples(self.time_s[rows], self.values[rows])

    def moved(self, shift_s: float) -> "Samples":
        """Return the same samples at later times."""
        return Samples(self.time_s + shift_s, self.values)


@dataclass(frozen=True, eq=False)
class Agreement:
    """How samples lie on those of a source.

    `agrees` and `differs`, shape (m,), are both false where a gap leaves nothing to compare; `at`
    is the source's row, and `exact` says that its sample itself is met, not the line to the next.
    """

    agrees: Mask
    differs: Mask
    compared: Mask  # (m, d)
    at: Indices
    exact: Mask


def agreement(
    source: Samples, samples: Samples, tolerance: Floats, *, spline: bool = False
) -> Agreement:
    """Hold samples against a source on the same clock.

    Parameters
    ----------
    source
        At least two samples.
    samples
        Those that are judged; outside of the source's time they differ.
    tolerance
        By which a channel may be off, shape (d,).
    spline
        Whether the line through the source's samples is a cubic spline instead of straight.
    """
    time_s, n = source.time_s, source.time_s.size
    row = np.clip(np.searchsorted(time_s, samples.time_s, side="right") - 1, 0, n - 2)
    share = (samples.time_s - time_s[row]) / (time_s[row + 1] - time_s[row])
    before, after = source.values[row], source.values[row + 1]
    between = (_spline(source) if spline else _straight(source))(samples.time_s)[0]
    # Beside a gap the line has no value where it begins and ends.
    between = np.where((share < HERE)[:, None], before, between)
    between = np.where((share > 1.0 - HERE)[:, None], after, between)
    inside = (share > -0.5) & (share < 1.5)
    met = np.zeros((3, row.size), dtype=np.bool_)
    seen = np.zeros((3, *samples.values.shape), dtype=np.bool_)
    for k, there in enumerate((before, after, between)):
        off = np.abs(samples.values - there)
        seen[k] = np.isfinite(off)
        met[k] = inside & ~(off > tolerance).any(axis=1)
    agreeing = met & np.any(seen, axis=2)
    which = np.argmax(agreeing, axis=0)
    agrees: Mask = np.any(agreeing, axis=0)
    compared = seen[which, np.arange(row.size)] & agrees[:, None]
    differs: Mask = ~np.any(met, axis=0)
    return Agreement(agrees, differs, compared, row + (which == 1), agrees & (which < 2))


def aligned(source: Samples, samples: Samples, tolerance: Floats, *, spline: bool) -> float:
    """Return by how much later samples lie best on the line through a source's, from nearby [s].

    The line is a cubic spline, or straight from sample to sample.
    """
    curve = _spline(source) if spline else _straight(source)
    longest_s = 0.5 * float(np.median(np.diff(source.time_s)))
    shift_s = 0.0
    for _ in range(STEPS):
        at, slope = curve(samples.time_s + shift_s)
        off, slope = (samples.values - at) / tolerance, slope / tolerance
        there = np.isfinite(off) & np.isfinite(slope)
        steep = float(np.sum(slope[there] ** 2))
        if steep == 0.0:
            break
        shift_s += float(np.clip(np.sum((slope * off)[there]) / steep, -longest_s, longest_s))
    return shift_s


Curve = Callable[[Floats], tuple[Floats, Floats]]  # values and slopes (m, d) at times (m,)


def _straight(source: Samples) -> Curve:
    time_s, values = source.time_s, source.values

    def at(moments: Floats) -> tuple[Floats, Floats]:
        row = np.clip(np.searchsorted(time_s, moments, side="right") - 1, 0, time_s.size - 2)
        slope = (values[row + 1] - values[row]) / (time_s[row + 1] - time_s[row])[:, None]
        return values[row] + (moments - time_s[row])[:, None] * slope, slope

    return at


def _spline(source: Samples) -> Curve:
    from scipy.interpolate import CubicSpline

    curves = []
    for values in source.values.T:
        there = np.isfinite(values)
        enough = np.count_nonzero(there) > 1
        curves.append(CubicSpline(source.time_s[there], values[there]) if enough else None)

    def at(moments: Floats) -> tuple[Floats, Floats]:
        nowhere = np.full(moments.size, np.nan)
        each = [(nowhere, nowhere) if c is None else (c(moments), c(moments, 1)) for c in curves]
        return np.column_stack([v for v, _ in each]), np.column_stack([s for _, s in each])

    return at
