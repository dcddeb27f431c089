"""Clean a driving signal that is too long for memory: `conditioning`, piece by piece.

Noise and the smallest reversal are those of the whole signal. Windows and corners are found in
each piece, with overlap into its neighbours. Between reversals the nearest monotone signal is
exact: where all samples so far lie below all that can still come in the stroke, the regression
separates into two. Only a rest or a creep longer than two pieces is cut: later samples are then
bounded by the last value already returned.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.conditioning import noise_and_memory, smallest_reversal, smooth_out
from tsas_cli.numerics.turning_points import turning_points

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]
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
    """Rows of a cleaned signal; the fields are those of `Conditioned`, `reversals` are rows.

    `apart_s` is the length of the gap that a row lies in, 0 for a finite sample, infinite before
    the first and after the last.
    """

    start: int
    values: Floats
    sd: Floats
    unseen: Floats
    apart_s: Floats
    reversals: Indices


@dataclass(frozen=True)
class _Smoothed:
    """Finite samples with their rows, and the times `all_s` of all rows read with them."""

    all_s: Floats
    rows: Indices
    time_s: Floats
    smooth: Floats
    sd: Floats


@dataclass(frozen=True)
class _Final:
    """Samples whose cleaned value is final."""

    all_s: Floats
    rows: Indices
    time_s: Floats
    clean: Floats
    sd: Floats
    unseen: Floats
    reversals: Indices


def plan(pieces: Iterable[Samples], count: int) -> CleaningPlan:
    """Return the estimates for a signal of `count` pieces: medians over them."""
    noise, memory, ratio, window, interval = [], [], [], [], []
    for number, (_, time_s, values) in enumerate(pieces):
        finite = np.isfinite(values)
        if finite.sum() < FEWEST:
            continue
        time_s, values = time_s[finite], values[finite]
        here, lasts = noise_and_memory(values)
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

    Parameters
    ----------
    pieces
        The signal in pieces, each of which begins with the last 2 `beside` rows of the one before.
    beside
        Rows at both ends of a piece that only support the fits of the others.
    plan
        The estimates for the whole signal.
    """
    last: _Final | None = None
    start, waiting = 0, np.empty(0)
    for final in _monotone(_smooth(pieces, beside, plan), plan):
        waiting = np.concatenate((waiting, final.all_s))
        if not final.rows.size:
            continue
        size = int(final.rows[-1]) + 1 - start
        yield _over_all_rows(start, waiting[:size], last, final)
        start, waiting, last = start + size, waiting[size:], _last_of(final)
    if waiting.size and last is not None:
        yield _over_all_rows(start, waiting, last, _no_samples())


def _smooth(pieces: Iterable[Samples], beside: int, plan: CleaningPlan) -> Iterator[_Smoothed]:
    """Yield each piece smoothed, without the overlap that the next one covers better."""
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
        yield _Smoothed(time_s[low:high], rows + start, time_s[rows], smooth[own], sd[own])
        now = after


def _monotone(parts: Iterable[_Smoothed], plan: CleaningPlan) -> Iterator[_Final]:
    """Yield the signal, monotone between reversals, as far as it is final."""
    pending: _Smoothed | None = None
    partly_regressed: Floats = np.empty(0)  # pending samples; the stroke before ends at the first
    direction, bound = 0, -np.inf
    most = 0
    for part in parts:
        most = max(most, part.all_s.size)
        pending = part if pending is None else _concatenated(pending, part)
        partly_regressed = np.concatenate((partly_regressed, part.smooth))
        reversals = turning_points(pending.smooth, plan.smallest_reversal, direction)[1:-1]
        out, done = partly_regressed.copy(), 0
        for reversal in reversals:
            direction = direction or _sign(pending.smooth[reversal] - pending.smooth[done])
            out[done : reversal + 1] = _rising(out[done : reversal + 1], direction, bound, plan)
            done, direction, bound = int(reversal), -direction, -np.inf
        direction = direction or _first_direction(pending.smooth, plan.smallest_reversal)
        known = done
        if direction:
            known += _count_final(direction * out[done:], plan.smallest_reversal)
        if known == done and pending.rows.size - done > 2 * most:
            direction = direction or _sign(out[-1] - out[done])
            known = pending.rows.size - most
        if known > done:
            out[done:known] = _rising(out[done:known], direction, bound, plan)
            bound = direction * out[known - 1]
        yield _final(pending, out, known, reversals)
        pending, partly_regressed = _after(pending, known), out[known:]
    if pending is not None and pending.rows.size:
        direction = direction or _sign(partly_regressed[-1] - partly_regressed[0])
        out = _rising(partly_regressed, direction, bound, plan)
        yield _final(pending, out, pending.rows.size, np.empty(0, dtype=np.int64))


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


def _concatenated(one: _Smoothed, other: _Smoothed) -> _Smoothed:
    return _Smoothed(
        other.all_s,  # those of the first part are returned already
        np.concatenate((one.rows, other.rows)),
        np.concatenate((one.time_s, other.time_s)),
        np.concatenate((one.smooth, other.smooth)),
        np.concatenate((one.sd, other.sd)),
    )


def _after(part: _Smoothed, first: int) -> _Smoothed:
    return _Smoothed(
        np.empty(0), part.rows[first:], part.time_s[first:], part.smooth[first:], part.sd[first:]
    )


def _final(pending: _Smoothed, out: Floats, known: int, reversals: Indices) -> _Final:
    clean = out[:known]
    return _Final(
        pending.all_s,
        pending.rows[:known],
        pending.time_s[:known],
        clean,
        pending.sd[:known],
        pending.smooth[:known] - clean,
        pending.rows[reversals],
    )


def _last_of(final: _Final) -> _Final:
    """Return the last sample alone, from which the next rows are interpolated."""
    return replace(
        final,
        rows=final.rows[-1:],
        time_s=final.time_s[-1:],
        clean=final.clean[-1:],
        sd=final.sd[-1:],
        unseen=final.unseen[-1:],
    )


def _no_samples() -> _Final:
    none = np.empty(0)
    rows = np.empty(0, dtype=np.int64)
    return _Final(none, rows, none, none, none, none, rows)


def _over_all_rows(start: int, time_s: Floats, last: _Final | None, final: _Final) -> Cleaned:
    """Return the values of all rows from `start` on, interpolated linearly between samples."""
    if final.rows.size == time_s.size:  # no gap
        none_s = np.zeros(time_s.size)
        return Cleaned(start, final.clean, final.sd, final.unseen, none_s, final.reversals)
    parts = [final] if last is None else [last, final]
    known_s = np.concatenate([part.time_s for part in parts])
    rows = np.arange(start, start + time_s.size)
    at = np.concatenate([part.rows for part in parts])
    before, after = np.searchsorted(at, rows, side="right") - 1, np.searchsorted(at, rows)
    apart_s = known_s[np.minimum(after, at.size - 1)] - known_s[np.maximum(before, 0)]
    apart_s[(before < 0) | (after >= at.size)] = np.inf
    values, sd, unseen = (
        np.interp(time_s, known_s, np.concatenate([getattr(part, name) for part in parts]))
        for name in ("clean", "sd", "unseen")
    )
    return Cleaned(start, values, sd, unseen, apart_s, final.reversals)
