"""Clean a driving signal that is too long for memory: `conditioning`, piece by piece.

Noise and the smallest reversal are those of the whole signal. Windows and corners are found in
each piece, with overlap into its neighbours. Between reversals the nearest monotone signal is
exact: where all samples so far lie below all that can still come in the stroke, the regression
separates into two. Only a rest or a creep longer than two pieces is cut: later samples are then
bounded by the last value already returned.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.numerics.conditioning import (
    Conditioned,
    memory_of,
    smallest_reversal,
    smooth_out,
)
from tsas_cli.numerics.noise import noise_of
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.support.arrays import Floats, Indices

Samples = tuple[int, Floats, Floats]  # number of the first row, times, values (NaN in gaps)

FEWEST = 16  # samples of a piece, below which it is not smoothed
PLANNED_PIECES = 8  # at most, from whose windows the smallest reversal is estimated
PLANNED_SAMPLES = 1 << 17  # of each of them, at most


@dataclass(frozen=True)
class CleaningPlan:
    """Estimates for the whole signal; `interval_s` is the median time between its samples."""

    noise: float
    memory: float
    smallest_reversal: float
    window_s: float
    interval_s: float


@dataclass(frozen=True)
class Cleaned:
    """Rows of a cleaned signal from row `start` on; `reversals` are rows of the whole signal.

    The `samples`, shape (4, n), are values, sd and unseen of `Conditioned`, and the length of the
    gap that a row lies in [s]: 0 for a finite sample, infinite before the first and after the last.
    """

    start: int
    samples: Floats
    reversals: Indices

    @property
    def values(self) -> Floats:
        """The cleaned values, shape (n,)."""
        return np.asarray(self.samples[0])

    @property
    def sd(self) -> Floats:
        """The standard deviation of their errors, shape (n,)."""
        return np.asarray(self.samples[1])

    @property
    def unseen(self) -> Floats:
        """The correction that makes them monotone between reversals, shape (n,)."""
        return np.asarray(self.samples[2])

    @property
    def apart_s(self) -> Floats:
        """The length of the gap that each row lies in, shape (n,) [s]."""
        return np.asarray(self.samples[3])


# Finite samples are arrays of four columns, shape (4, n): row, time, smooth value, sd; with a
# fifth, the cleaned value, where that is final.
_ROW, _TIME, _SMOOTH, _SD = range(4)
_NO_REVERSALS = np.empty(0, dtype=np.int64)


def plan(pieces: Iterable[Samples], count: int) -> CleaningPlan:
    """Return the estimates for a signal of `count` pieces: medians over them."""
    noise, memory, ratio, window, interval = [], [], [], [], []
    for number, (_, time_s, values) in enumerate(pieces):
        finite = np.isfinite(values)
        if finite.sum() < FEWEST:
            continue
        time_s, values = time_s[finite], values[finite]
        found = noise_of(values, time_s)
        here, lasts = found.sd, memory_of(values, found)
        noise.append(here)
        memory.append(lasts)
        interval.append(float(np.median(np.diff(time_s))))
        if here > 0.0 and number % -(-count // PLANNED_PIECES) == 0:
            _, sd, window_s = smooth_out(
                time_s[:PLANNED_SAMPLES], values[:PLANNED_SAMPLES], here, lasts
            )
            ratio.append(smallest_reversal(sd, here) / here)
            window.append(window_s)
    usual = float(np.median(noise)) if noise else 0.0
    return CleaningPlan(
        usual,
        float(np.median(memory)) if noise else 1.0,
        usual * float(np.median(ratio)) if ratio else 0.0,
        float(np.median(window)) if window else 0.0,
        float(np.median(interval)) if noise else 0.0,
    )


def cleaned(pieces: Iterable[Samples], beside: int, plan: CleaningPlan) -> Iterator[Cleaned]:
    """Yield the rows of the cleaned signal in order, as they become final.

    Each of the `pieces` begins with the last 2 `beside` rows of the one before: so many rows at
    both ends only support the fits of the others.
    """
    last = np.empty((5, 0))  # the final sample before those that wait
    start, waiting = 0, np.empty(0)
    for all_s, final, reversals in _monotone(_smooth(pieces, beside, plan), plan):
        waiting = np.concatenate((waiting, all_s))
        if not final.shape[1]:
            continue
        size = int(final[_ROW, -1]) + 1 - start
        if final.shape[1] < size:
            yield _over_all_rows(start, waiting[:size], np.hstack((last, final)), reversals)
        else:  # no gap
            _, _, smooth, sd, clean = final
            yield Cleaned(start, np.array([clean, sd, smooth - clean, np.zeros(size)]), reversals)
        start, waiting, last = start + size, waiting[size:], final[:, -1:]
    if waiting.size and last.shape[1]:
        yield _over_all_rows(start, waiting, last, _NO_REVERSALS)


def _smooth(
    pieces: Iterable[Samples], beside: int, plan: CleaningPlan
) -> Iterator[tuple[Floats, Floats]]:
    """Yield the times of all rows of each piece, and its finite samples smoothed.

    They are without the overlap that the next piece covers better.
    """
    upcoming = iter(pieces)
    now: Samples | None = next(upcoming)
    while now is not None:
        after = next(upcoming, None)
        start, time_s, values = now
        low = beside if start else 0
        high = values.size - (beside if after else 0)
        finite = np.flatnonzero(np.isfinite(values))
        smooth, sd = values[finite], np.full(finite.size, plan.noise)
        if plan.noise > 0.0 and finite.size >= FEWEST:
            smooth, sd, _ = smooth_out(time_s[finite], smooth, plan.noise, plan.memory)
        own = slice(*np.searchsorted(finite, (low, high)))
        rows = finite[own]
        yield time_s[low:high], np.array([rows + start, time_s[rows], smooth[own], sd[own]])
        now = after


def _monotone(
    parts: Iterable[tuple[Floats, Floats]], plan: CleaningPlan
) -> Iterator[tuple[Floats, Floats, Indices]]:
    """Yield the times of each part's rows, the samples that are final then, and the reversals."""
    pending = np.empty((4, 0))
    partly_regressed: Floats = np.empty(0)  # pending samples; the stroke before ends at the first
    direction, bound = 0, -np.inf
    most = 0
    for all_s, part in parts:
        most = max(most, all_s.size)
        pending = np.hstack((pending, part))
        smooth = pending[_SMOOTH]
        reversals = turning_points(smooth, plan.smallest_reversal, direction)[1:-1]
        out, done = np.concatenate((partly_regressed, part[_SMOOTH])), 0
        for reversal in reversals:
            direction = direction or _sign(smooth[reversal] - smooth[done])
            out[done : reversal + 1] = _rising(out[done : reversal + 1], direction, bound, plan)
            done, direction, bound = int(reversal), -direction, -np.inf
        direction = direction or _first_direction(smooth, plan.smallest_reversal)
        known = done
        if direction:
            known += _count_final(direction * out[done:], plan.smallest_reversal)
        if known == done and out.size - done > 2 * most:
            direction = direction or _sign(out[-1] - out[done])
            known = out.size - most
        if known > done:
            out[done:known] = _rising(out[done:known], direction, bound, plan)
            bound = direction * out[known - 1]
        rows = pending[_ROW, reversals].astype(np.int64)
        yield all_s, np.vstack((pending[:, :known], out[:known])), rows
        pending, partly_regressed = pending[:, known:], out[known:]
    if partly_regressed.size:
        direction = direction or _sign(partly_regressed[-1] - partly_regressed[0])
        out = _rising(partly_regressed, direction, bound, plan)
        yield np.empty(0), np.vstack((pending, out)), _NO_REVERSALS


def _rising(values: Floats, direction: int, bound: float, plan: CleaningPlan) -> Floats:
    """Return the nearest monotone signal beyond the value that the stroke has reached before."""
    from scipy.optimize import isotonic_regression

    if plan.noise == 0.0:
        return values
    out: Floats = isotonic_regression(values, increasing=direction > 0).x
    return direction * np.maximum(direction * out, bound)


def _count_final(rising: Floats, threshold: float) -> int:
    """Return how many samples of a stroke lie below all later ones, present and still to come."""
    highest = np.maximum.accumulate(rising)
    lowest_after = np.minimum.accumulate(rising[::-1])[::-1]
    apart = highest[:-1] <= np.minimum(lowest_after[1:], highest[-1] - threshold)
    found = np.flatnonzero(apart)
    return int(found[-1]) + 1 if found.size else 0


def _first_direction(values: Floats, threshold: float) -> int:
    """Return the direction of the first move beyond a threshold, 0 where there is none."""
    up = values - np.minimum.accumulate(values) > threshold
    down = np.maximum.accumulate(values) - values > threshold
    if not (up.any() or down.any()):
        return 0
    first_up = int(up.argmax()) if up.any() else values.size
    first_down = int(down.argmax()) if down.any() else values.size
    return 1 if first_up < first_down else -1


def _sign(change: float) -> int:
    return 1 if change >= 0.0 else -1


def _over_all_rows(start: int, time_s: Floats, known: Floats, reversals: Indices) -> Cleaned:
    """Return all rows from `start` on, interpolated linearly between known final samples."""
    at, at_s, smooth, sd, clean = known
    rows = np.arange(start, start + time_s.size)
    before, after = np.searchsorted(at, rows, side="right") - 1, np.searchsorted(at, rows)
    apart_s = at_s[np.minimum(after, at.size - 1)] - at_s[np.maximum(before, 0)]
    apart_s[(before < 0) | (after >= at.size)] = np.inf
    over_all = [np.interp(time_s, at_s, column) for column in (clean, sd, smooth - clean)]
    return Cleaned(start, np.array([*over_all, apart_s]), reversals)


class Aligned:
    """A cleaned signal, returned in pieces of any number of rows."""

    def __init__(self, stream: Iterator[Cleaned]) -> None:
        self.stream = stream
        self.pending = next(stream)

    def take(self, rows: int) -> Cleaned:
        """Return the next rows, with the reversals within them."""
        waiting, count = [self.pending], self.pending.values.size
        while count < rows:
            waiting.append(next(self.stream))
            count += waiting[-1].values.size
        whole = _concatenated(waiting)
        # The reversal that ends the final samples comes with them, but belongs to the next rows.
        border = int(np.searchsorted(whole.reversals, whole.start + rows))
        self.pending = _part(whole, slice(rows, None), whole.reversals[border:])
        return _part(whole, slice(0, rows), whole.reversals[:border])


def _part(whole: Cleaned, rows: slice, reversals: Indices) -> Cleaned:
    return Cleaned(whole.start + (rows.start or 0), whole.samples[:, rows], reversals)


def _concatenated(parts: Sequence[Cleaned]) -> Cleaned:
    return Cleaned(
        parts[0].start,
        np.hstack([part.samples for part in parts]),
        np.concatenate([part.reversals for part in parts]),
    )


def joined(parts: Sequence[Cleaned], known: CleaningPlan, size: int) -> Conditioned:
    """Return the conditioned signal of so many rows, from all its parts in order."""
    starts = np.cumsum([0, *(part.values.size for part in parts)])
    reversals = [part.reversals + start for part, start in zip(parts, starts[:-1], strict=True)]
    whole = _concatenated(parts)
    return Conditioned(
        whole.values,
        whole.sd,
        whole.unseen,
        known.window_s,
        known.noise,
        np.unique(np.concatenate(([0], *reversals, [size - 1]))),
        known.smallest_reversal,
    )
