"""The checks for channels that repeat their own values."""

import math
from collections.abc import Sequence

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.samples import (
    alternates,
    is_held,
    rows_between_changes,
    smallest_change,
)
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats, Indices
from tsas_cli.support.wording import count_of

_ONE_STEP, _DEVIATIONS = 1.2, 4.0  # times the share of changes by one step, and its deviations
_TWO_STEPS = 0.4  # changes by two steps over those by one, in noise that is larger than the steps


def repeated_values(trial: RunSignals) -> Findings:
    """A channel repeats its value far more often than its noise would: a median filter before it.

    A median keeps one sample of its window until another one is in the middle. Reported where a
    channel whose noise is larger than its steps repeats its value more often than it changes by one
    step, at irregular intervals; at regular ones it is updated less often (`slow-channel`). An
    encoder that rests, or hunts, repeats its value too, and is no such channel, however it swings
    elsewhere: it seldom changes by two steps where it changes by one.
    """
    fresh = ~trial.repeats
    for name, values in trial.mechanical.items():
        if not trial.is_noisy(name) or is_held(values[fresh]):
            continue
        share, chance = _beside_one_step(values[fresh], trial.sizes[name].step)
        if share > chance:
            yield warning(
                name,
                f"{name} repeats its value in {100.0 * share:.2g} % of the rows, its noise would "
                f"in {100.0 * chance:.2g} %: as behind a median filter",
                "record the channel without the filter",
            )


def _beside_one_step(values: Floats, step: float) -> tuple[float, float]:
    """Return the share of repeats and that of changes by one step; (0, 0) where they are alike.

    A clipped channel repeats its values too, but at one end: both halves of the span have to.
    """
    steps = np.abs(np.diff(values))
    steps = np.rint(steps / (step or smallest_change(values)))
    high = values[1:] > 0.5 * (np.nanmin(values) + np.nanmax(values))
    for half in (steps[high], steps[~high]):
        if half.size == 0:
            return 0.0, 0.0
        repeats, one, two = (float(np.mean(half == n)) / (1 + (n > 0)) for n in range(3))
        deviation = math.sqrt((repeats + 0.5 * one) / half.size)
        more = repeats > max(_ONE_STEP * one, one + _DEVIATIONS * deviation)
        if one == 0.0 or not more or two < _TWO_STEPS * one:
            return 0.0, 0.0
    return float(np.mean(steps == 0.0)), 0.5 * float(np.mean(steps == 1.0))


def slow_channel(trial: RunSignals) -> Findings:
    """A channel is updated less often than the rows are written.

    Its sensor updates at a lower rate and the logger repeats the last value (zero-order hold), so
    the channel is late by half an update on average. An encoder in slow motion also rests between
    its steps, but moves by one step at a time; a channel under zero-order hold jumps.
    """
    fresh = ~trial.repeats
    for name, values in trial.mechanical.items():
        if not is_held(values[fresh]):
            continue
        change = np.abs(np.diff(values))
        if np.nanmedian(change[change > 0.0]) > 1.5 * smallest_change(values):
            rows = rows_between_changes(values[fresh])
            yield warning(
                name,
                f"{name} changes only every {np.median(rows):.0f} rows (zero-order hold)",
                "record the channel at its own rate, or correct for half an update of delay",
            )


_FEWEST_OF_A_BUFFER, _MOST_OF_A_BUFFER = 4, 512  # rows
_BY_CHANCE = 1e-4  # expected number of blocks that repeat
_NEARBY = 32  # rows on either side of a block


def repeated_buffer(trial: RunSignals) -> Findings:
    """A block of rows is written twice, one after the other, and the times run on.

    A driver that hands out its buffer again when no new one is ready. Every channel of it then
    repeats, to the last digit, as many rows as the block has, of which at most 512 are sought.
    Noise never does, but in a rest, where it takes few values, some rows may; a computed recording
    without noise repeats whole periods, but more than once.
    """
    noisy = {n: values for n, values in trial.channels.items() if alternates(values)}
    if not noisy:
        yield NotChecked("no channel has noise, so rows may repeat by themselves")
        return
    everything = np.column_stack([np.nan_to_num(values) for values in trial.channels.values()])
    of_all = _blocks_again(everything)
    if of_all:
        yield _buffers(trial, None, of_all)
        return
    for name in [n for n in noisy if n.startswith("f_")]:  # an encoder may count the same again
        if blocks := _blocks_again(np.nan_to_num(noisy[name])[:, None]):
            yield _buffers(trial, name, blocks)


def _buffers(trial: RunSignals, column: str | None, blocks: Sequence[tuple[int, int]]) -> Finding:
    """Return that blocks of rows, from and to, repeat those before in one column or in all."""
    start, stop = blocks[0]
    which = "all channels" if column is None else column
    return error(
        column,
        f"{count_of(len(blocks), 'block')} of rows repeat the block before in {which}; "
        f"the first has {stop - start} rows and begins at {trial.time_s[start]:.6g} s, "
        f"row {trial.first_row + start}",
        "write each buffer once; remove the repeated rows with their times at the source",
        float(trial.time_s[start]),
    )


def _blocks_again(table: Floats) -> list[tuple[int, int]]:
    """Return the blocks of rows, from and to, that repeat the block before, shape (n, columns).

    What repeats more than once is periodic.
    """
    row = np.unique(table, axis=0, return_inverse=True)[1].ravel()
    found = []
    for size in range(_FEWEST_OF_A_BUFFER, min(_MOST_OF_A_BUFFER, row.size // 2) + 1):
        again = np.concatenate((np.zeros(size, bool), row[size:] == row[:-size], [False]))
        if np.count_nonzero(again) < size:
            continue
        edges = np.flatnonzero(again[1:] != again[:-1]) + 1
        lengths = edges[1::2] - edges[::2]
        for k in np.flatnonzero((lengths >= size) & (lengths < 2 * size)):
            start = int(edges[2 * k])
            if not _by_chance(row, start, start + size):
                found.append((start, start + size))
    return sorted(found)


def _by_chance(row: Indices, start: int, stop: int) -> bool:
    """Return whether as many rows repeat those before somewhere by chance, as rows do nearby.

    `row` has the same number for rows that are alike, shape (n,). A row like the one before it
    tells nothing.
    """
    counts = np.bincount(row[max(start - _NEARBY, 0) : stop + _NEARBY])
    pairs = float(np.sum(counts * (counts - 1))) / (counts.sum() * (counts.sum() - 1))
    changes = np.count_nonzero(np.diff(row[start:stop]))
    return bool(row.size * pairs**changes > _BY_CHANCE)
