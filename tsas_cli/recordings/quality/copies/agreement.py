"""A copy, and the agreement of a run's samples with another's, or their interpolation."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import Run
from tsas_cli.support.arrays import Floats, Indices, Mask

WHOLE_SHARE = 0.98  # of a run's samples; the rest is its edges
CONDITION_TOLERANCE = 1e-3  # relative: 3.14 rad is π
ORDINALS = {1: "st", 2: "nd", 3: "rd"}
MARGIN_ROWS = 32  # on either side, beyond which a spline does not depend on its end
TIME_TOLERANCE = 1e-6  # of a sample interval, by which the times of a copy are rounded
ITERATIONS = 8  # of Gauss–Newton, from within a sample interval


@dataclass(frozen=True)
class RowSpan:
    """Consecutive rows of a run, `end` excluded, and the times of the first and last [s]."""

    first: int
    end: int
    begin_s: float
    end_s: float

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.end - self.first

    @property
    def duration_s(self) -> float:
        """Duration [s]."""
        return self.end_s - self.begin_s


@dataclass(frozen=True)
class Copy:
    """A stretch of a run whose samples are those of another run."""

    run: Run  # that holds the copy
    other: Run  # the original
    span: RowSpan
    all_of_run: RowSpan
    all_of_other: RowSpan
    shift_s: float = 0.0  # of the samples to the other run's clock
    every: int = 1  # k if it holds every k-th sample of the original; 0 if it is interpolated
    contradicts: tuple[str, ...] = ()  # conditions that differ between the two in the manifest

    @property
    def whole(self) -> bool:
        """Whether the whole run is a copy."""
        return self.span.rows >= WHOLE_SHARE * self.all_of_run.rows

    @property
    def sentence(self) -> str:
        """Description of the copy, a predicate for the name of the run."""
        here = f"from {self.span.begin_s:.6g} s to {self.span.end_s:.6g} s"
        there = (self.span.begin_s + self.shift_s, self.span.end_s + self.shift_s)
        there_s = f"from {there[0]:.6g} s to {there[1]:.6g} s"
        if not self.whole:
            return f"holds, {here}, {self._samples} {there_s}{self._resampled}"
        if self.span.duration_s < WHOLE_SHARE * self.all_of_other.duration_s:
            return f"holds {self._samples} {there_s}{self._resampled}"
        shifted = abs(self.shift_s) * self.all_of_run.rows > self.all_of_run.duration_s
        by = f", its time shifted by {-self.shift_s:.6g} s" if shifted else ""
        return f"holds {self._samples}{self._resampled}{by}"

    @property
    def contradiction(self) -> str:
        """The differing conditions, as the end of a sentence; empty without any."""
        differing = [
            f"{name} = {_text(getattr(self.run, name))} here and "
            f"{_text(getattr(self.other, name))} there"
            for name in self.contradicts
        ]
        return f", but the manifest says {', '.join(differing)}" if differing else ""

    @property
    def _samples(self) -> str:
        other = f"run {self.other.id}"
        if self.every < 2:
            return f"the samples of {other}"
        tens = self.every % 100 in (11, 12, 13)
        ordinal = "th" if tens else ORDINALS.get(self.every % 10, "th")
        return f"every {self.every}{ordinal} sample of {other}"

    @property
    def _resampled(self) -> str:
        if self.every > 0:
            return ""
        return f", resampled at {(self.all_of_run.rows - 1) / self.all_of_run.duration_s:.5g} Hz"


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
        every, exact = 0, found.exact[first:end]
        if np.count_nonzero(exact) >= EXACT_SHARE * np.count_nonzero(found.agrees[first:end]):
            every = max(int(np.median(np.diff(found.at[first:end][exact]))), 1)
        out.append((span, every))
    return out


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


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def contradictions(run: Run, other: Run) -> tuple[str, ...]:
    """Return the conditions that differ between two runs by more than rounding."""
    stated = [(name, getattr(run, name), getattr(other, name)) for name in CONDITIONS]
    different = [
        name
        for name, a, b in stated
        if not (a is None or b is None or math.isclose(a, b, rel_tol=CONDITION_TOLERANCE))
    ]
    return (*different, "load") if run.load != other.load else tuple(different)
