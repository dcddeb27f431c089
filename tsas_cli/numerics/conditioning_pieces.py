"""Clean a driving signal that is too long for memory: what `conditioning` does, piece by piece.

Noise and the smallest reversal are those of the whole signal. Windows and corners are sought in
each piece, with some of its neighbours' samples beside it. Between reversals the nearest monotone
signal is found exactly: where all samples so far lie below all that can still come in the stroke,
the regression falls apart into two. Only a rest or a creep that lasts for more than two pieces is
cut: what follows then keeps above (or below) what is already told.
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

FEWEST = 16  # samples of a piece, below which nothing is smoothed
LOOKED_AT = 8  # pieces at most, whose windows tell the smallest reversal,
SAMPLES = 1 << 17  # and so many samples of each


@dataclass(frozen=True)
class Plan:
    """What holds for the whole signal; `interval_s` is the usual time between its samples."""

    noise: float
    memory: float
    smallest_reversal: float
    window_s: float
    interval_s: float


@dataclass(frozen=True)
class Cleaned:
    """Rows of a cleaned signal; the fields are those of `Conditioned`, `reversals` are rows.

    `apart_s` is the time between the samples on both sides of a row that holds none, 0 where it
    holds one, infinite before the first and after the last.
    """

    start: int
    values: Floats
    sd: Floats
    unseen: Floats
    apart_s: Floats
    reversals: Indices


@dataclass(frozen=True)
class _Part:
    """Samples that are there, with their rows, and the times of all rows that came with them."""

    all_s: Floats
    rows: Indices
    time_s: Floats
    smooth: Floats
    sd: Floats


@dataclass(frozen=True)
class _Final:
    """Samples whose cleaned value is known."""

    all_s: Floats
    rows: Indices
    time_s: Floats
    clean: Floats
    sd: Floats
    unseen: Floats
    turns: Indices


def plan(pieces: Iterable[Samples], count: int) -> Plan:
    """Return what holds for a signal of `count` pieces: medians over them."""
    noise, memory, ratio, window, interval = [], [], [], [], []
    for number, (_, time_s, values) in enumerate(pieces):
        there = np.isfinite(values)
        if there.sum() < FEWEST:
            continue
        time_s, values = time_s[there], values[there]
        here, lasts = noise_and_memory(values)
        noise.append(here)
        memory.append(lasts)
        interval.append(float(np.median(np.diff(time_s))))
        if here > 0.0 and number % -(-count // LOOKED_AT) == 0:
            _, sd, window_s = smooth_out(time_s[:SAMPLES], values[:SAMPLES], here, lasts)
            ratio.append(smallest_reversal(sd, here) / here)
            window.append(window_s)
    usual = float(np.median(noise)) if noise else 0.0
    return Plan(
        usual,
        float(np.median(memory)) if noise else 1.0,
        usual * float(np.median(ratio)) if ratio else 0.0,
        float(np.median(window)) if window else 0.0,
        float(np.median(interval)) if noise else 0.0,
    )


def cleaned(pieces: Iterable[Samples], beside: int, plan: Plan) -> Iterator[Cleaned]:
    """Clean a signal; yields rows in order, as many as are known at a time.

    Parameters
    ----------
    pieces
        The signal in pieces, each of which begins with the last 2 `beside` rows of the one before.
    beside
        Rows at both ends of a piece that only help to smooth the others.
    plan
        What holds for the whole signal.
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
        yield _over_all_rows(start, waiting, last, _nothing())


def _smooth(pieces: Iterable[Samples], beside: int, plan: Plan) -> Iterator[_Part]:
    """Smooth each piece; yield the rows that the next one does not know better."""
    coming = iter(pieces)
    now: Samples | None = next(coming)
    while now is not None:
        after = next(coming, None)
        start, time_s, values = now
        low = beside if start else 0
        high = values.size - (beside if after else 0)
        there = np.flatnonzero(np.isfinite(values))
        smooth, sd = values[there], np.full(there.size, plan.noise)
        if plan.noise > 0.0 and there.size >= FEWEST:
            smooth, sd, _ = smooth_out(time_s[there], smooth, plan.noise, plan.memory)
        own = slice(*np.searchsorted(there, (low, high)))
        rows = there[own]
        yield _Part(time_s[low:high], rows + start, time_s[rows], smooth[own], sd[own])
        now = after


def _monotone(parts: Iterable[_Part], plan: Plan) -> Iterator[_Final]:
    """Make the signal monotone between reversals; yield what is known for sure."""
    held: _Part | None = None
    begun: Floats = np.empty(0)  # the held samples as the stroke before has left the first of them
    direction, bound = 0, -np.inf
    most = 0
    for part in parts:
        most = max(most, part.all_s.size)
        held = part if held is None else _joined(held, part)
        begun = np.concatenate((begun, part.smooth))
        turns = turning_points(held.smooth, plan.smallest_reversal, direction)[1:-1]
        out, done = begun.copy(), 0
        for turn in turns:
            direction = direction or _sign(held.smooth[turn] - held.smooth[done])
            out[done : turn + 1] = _rising(out[done : turn + 1], direction, bound, plan)
            done, direction, bound = int(turn), -direction, -np.inf
        direction = direction or _first_direction(held.smooth, plan.smallest_reversal)
        known = done
        if direction:
            known += _known(direction * out[done:], plan.smallest_reversal)
        if known == done and held.rows.size - done > 2 * most:
            direction = direction or _sign(out[-1] - out[done])
            known = held.rows.size - most
        if known > done:
            out[done:known] = _rising(out[done:known], direction, bound, plan)
            bound = direction * out[known - 1]
        yield _final(held, out, known, turns)
        held, begun = _rest(held, known), out[known:]
    if held is not None and held.rows.size:
        direction = direction or _sign(begun[-1] - begun[0])
        out = _rising(begun, direction, bound, plan)
        yield _final(held, out, held.rows.size, np.empty(0, dtype=np.int64))


def _rising(values: Floats, direction: int, bound: float, plan: Plan) -> Floats:
    """Return the nearest monotone signal that keeps beyond what the stroke has reached before."""
    from scipy.optimize import isotonic_regression

    if plan.noise == 0.0:
        return values
    out: Floats = isotonic_regression(values, increasing=direction > 0).x
    return direction * np.maximum(direction * out, bound)


def _known(rising: Floats, threshold: float) -> int:
    """Return how many samples of a stroke lie below all others, and all that can still come."""
    highest = np.maximum.accumulate(rising)
    lowest_after = np.minimum.accumulate(rising[::-1])[::-1]
    apart = highest[:-1] <= np.minimum(lowest_after[1:], highest[-1] - threshold)
    found = np.flatnonzero(apart)
    return int(found[-1]) + 1 if found.size else 0


def _first_direction(values: Floats, threshold: float) -> int:
    """Return in which direction a signal moves first by more than a threshold, 0 if it does not."""
    up = values - np.minimum.accumulate(values) > threshold
    down = np.maximum.accumulate(values) - values > threshold
    if not (up.any() or down.any()):
        return 0
    first_up = int(up.argmax()) if up.any() else values.size
    first_down = int(down.argmax()) if down.any() else values.size
    return 1 if first_up < first_down else -1


def _sign(change: float) -> int:
    return 1 if change >= 0.0 else -1


def _joined(one: _Part, other: _Part) -> _Part:
    return _Part(
        other.all_s,  # those of the first part are told already
        np.concatenate((one.rows, other.rows)),
        np.concatenate((one.time_s, other.time_s)),
        np.concatenate((one.smooth, other.smooth)),
        np.concatenate((one.sd, other.sd)),
    )


def _rest(part: _Part, first: int) -> _Part:
    return _Part(
        np.empty(0), part.rows[first:], part.time_s[first:], part.smooth[first:], part.sd[first:]
    )


def _final(held: _Part, out: Floats, known: int, turns: Indices) -> _Final:
    clean = out[:known]
    return _Final(
        held.all_s,
        held.rows[:known],
        held.time_s[:known],
        clean,
        held.sd[:known],
        held.smooth[:known] - clean,
        held.rows[turns],
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


def _nothing() -> _Final:
    none = np.empty(0)
    rows = np.empty(0, dtype=np.int64)
    return _Final(none, rows, none, none, none, none, rows)


def _over_all_rows(start: int, time_s: Floats, last: _Final | None, final: _Final) -> Cleaned:
    """Lay samples over all rows from `start` on, straight between them."""
    if final.rows.size == time_s.size:  # no gap
        none_s = np.zeros(time_s.size)
        return Cleaned(start, final.clean, final.sd, final.unseen, none_s, final.turns)
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
    return Cleaned(start, values, sd, unseen, apart_s, final.turns)
