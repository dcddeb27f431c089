"""Agreement of a run's samples with another's, or their interpolation, and for how long."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.quality.copies.copy import RowSpan
from tsas_cli.support.arrays import Floats, Indices, Mask

MARGIN_ROWS = 32  # on either side, beyond which a spline does not depend on its end
TIME_TOLERANCE = 1e-6  # of a sample interval, by which the times of a copy are rounded
ITERATIONS = 8  # of Gauss–Newton, from within a sample interval


@dataclass(frozen=True, eq=False)
class RunSamples:
    """Times, shape (n,) and strictly increasing, and values of some channels, shape (n, d)."""

    time_s: Floats
    values: Floats

    def part(self, rows: slice) -> "RunSamples":
        """Return a part of the rows."""
        return RunSamples(self.time_s[rows], self.values[rows])

    def moved(self, shift_s: float) -> "RunSamples":
        """Return the samples at times later by `shift_s`."""
        return RunSamples(self.time_s + shift_s, self.values)


@dataclass(frozen=True, eq=False)
class Agreement:
    """Agreement of m samples with those of a source.

    `agrees` and `differs`, shape (m,), are both false where a gap leaves nothing to compare; `at`
    is the row of the source, and `exact` marks agreement with its sample, not the interpolation.
    """

    agrees: Mask
    differs: Mask
    compared: Mask  # (m, d)
    at: Indices
    exact: Mask


def agreement(
    source: RunSamples, samples: RunSamples, tolerance: Floats, *, spline: bool = False
) -> Agreement:
    """Return the agreement of samples with a source of at least two, on the same clock.

    Beyond the source's times samples differ. The tolerance is the largest deviation of each
    channel, shape (d,); the interpolation is linear, or a cubic spline.
    """
    time_s, n = source.time_s, source.time_s.size
    row = np.clip(np.searchsorted(time_s, samples.time_s, side="right") - 1, 0, n - 2)
    share = (samples.time_s - time_s[row]) / (time_s[row + 1] - time_s[row])
    before, after = source.values[row], source.values[row + 1]
    between = (_spline(source) if spline else _straight(source))(samples.time_s)[0]
    # Next to a gap the interpolation is undefined at its end samples.
    between = np.where((share < TIME_TOLERANCE)[:, None], before, between)
    between = np.where((share > 1.0 - TIME_TOLERANCE)[:, None], after, between)
    inside = (share > -0.5) & (share < 1.5)
    met = np.zeros((3, row.size), dtype=np.bool_)
    comparable = np.zeros((3, *samples.values.shape), dtype=np.bool_)
    for k, expected in enumerate((before, after, between)):
        off = np.abs(samples.values - expected)
        comparable[k] = np.isfinite(off)
        met[k] = inside & ~(off > tolerance).any(axis=1)
    agreeing = met & np.any(comparable, axis=2)
    which = np.argmax(agreeing, axis=0)
    agrees: Mask = np.any(agreeing, axis=0)
    compared = comparable[which, np.arange(row.size)] & agrees[:, None]
    differs: Mask = ~np.any(met, axis=0)
    return Agreement(agrees, differs, compared, row + (which == 1), agrees & (which < 2))


def aligned(source: RunSamples, samples: RunSamples, tolerance: Floats, *, spline: bool) -> float:
    """Return the time shift of samples that fits a source's interpolation best, from nearby [s].

    The interpolation is a cubic spline, or linear.
    """
    curve = _spline(source) if spline else _straight(source)
    longest_s = 0.5 * float(np.median(np.diff(source.time_s)))
    shift_s = 0.0
    for _ in range(ITERATIONS):
        at, slope = curve(samples.time_s + shift_s)
        off, slope = (samples.values - at) / tolerance, slope / tolerance
        valid = np.isfinite(off) & np.isfinite(slope)
        steep = float(np.sum(slope[valid] ** 2))
        if steep == 0.0:
            break
        shift_s += float(np.clip(np.sum((slope * off)[valid]) / steep, -longest_s, longest_s))
    return shift_s


_Curve = Callable[[Floats], tuple[Floats, Floats]]  # values and slopes (m, d) at times (m,)


def _straight(source: RunSamples) -> _Curve:
    time_s, values = source.time_s, source.values

    def at(moments: Floats) -> tuple[Floats, Floats]:
        row = np.clip(np.searchsorted(time_s, moments, side="right") - 1, 0, time_s.size - 2)
        slope = (values[row + 1] - values[row]) / (time_s[row + 1] - time_s[row])[:, None]
        return values[row] + (moments - time_s[row])[:, None] * slope, slope

    return at


def _spline(source: RunSamples) -> _Curve:
    from scipy.interpolate import CubicSpline

    curves = []
    for values in source.values.T:
        valid = np.isfinite(values)
        enough = np.count_nonzero(valid) > 1
        curves.append(CubicSpline(source.time_s[valid], values[valid]) if enough else None)

    def at(moments: Floats) -> tuple[Floats, Floats]:
        nowhere = np.full(moments.size, np.nan)
        each = [(nowhere, nowhere) if c is None else (c(moments), c(moments, 1)) for c in curves]
        return np.column_stack([v for v, _ in each]), np.column_stack([s for _, s in each])

    return at


LEAST_INFORMATION = 40.0  # nats: by chance at one of 10¹⁷ shifts
MOST_PER_SAMPLE = 2.5  # nats: noise may be correlated
GAP_SHARE = 0.01  # of two stretches that may differ between them if they are one
EXACT_SHARE = 0.9  # of a stretch's samples that are the source's own, not interpolated


def stretches(
    row: int, samples: RunSamples, found: Agreement, information: Floats
) -> list[tuple[RowSpan, int]]:
    """Return the stretches of agreeing consecutive samples, each with its `every` (see `Copy`).

    `row` is the number of the first sample, `information` −ln of the probability that a repeat
    agrees with a changing sample [nats], shape (d,).
    """
    changed = np.zeros(samples.values.shape, dtype=np.bool_)
    changed[1:] = samples.values[1:] != samples.values[:-1]
    nats = np.minimum((found.compared & changed) @ information, MOST_PER_SAMPLE)
    edges = np.concatenate(([-1], np.flatnonzero(found.differs), [nats.size]))
    sums = np.concatenate(([0.0], np.cumsum(np.where(found.agrees, nats, 0.0))))
    out = []
    for k in np.flatnonzero(sums[edges[1:]] - sums[edges[:-1] + 1] >= LEAST_INFORMATION).tolist():
        first, end = int(edges[k]) + 1, int(edges[k + 1])
        times = samples.time_s[first], samples.time_s[end - 1]
        span = RowSpan(row + first, row + end, float(times[0]), float(times[1]))
        out.append((span, _every(found, slice(first, end))))
    return out


def _every(found: Agreement, rows: slice) -> int:
    """Return the rows of the source from one sample to the next; 0 if they are interpolated."""
    exact = found.exact[rows]
    if np.count_nonzero(exact) < EXACT_SHARE * np.count_nonzero(found.agrees[rows]):
        return 0
    return max(int(np.median(np.diff(found.at[rows][exact]))), 1)


def joined(parts: Iterable[tuple[RowSpan, int]]) -> list[tuple[RowSpan, int]]:
    """Return stretches in order, merged if only a few samples differ between them."""
    out: list[tuple[RowSpan, int]] = []
    for span, every in parts:
        before = out[-1][0] if out else None
        if before and span.first - before.end <= GAP_SHARE * (before.rows + span.rows):
            out[-1] = RowSpan(before.first, span.end, before.begin_s, span.end_s), out[-1][1]
        else:
            out.append((span, every))
    return out
