"""The checks for channels that repeat their own values."""

import math

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings
from tsas_cli.recordings.quality.samples import is_held, rows_between_changes, smallest_change
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_BLOCK = 32  # rows
_CALM, _FEWEST_BLOCKS = 0.15, 4  # of all blocks
_MORE, _MOST = 2.0, 0.3  # times the share by chance, and share beyond that
_ONE_STEP, _DEVIATIONS = 1.2, 4.0  # times the share of changes by one step, and its deviations


def repeated_values(trial: RunSignals) -> Findings:
    """A channel repeats its value far more often than its noise would: a median filter before it.

    A median keeps one sample of its window until another one is in the middle. Reported where a
    channel whose noise is larger than its steps repeats neighbours where it moves least, or
    anywhere more often than it changes by one step, at irregular intervals; at regular ones it is
    updated less often (`slow-channel`).
    """
    fresh = ~trial.repeats
    for name, values in trial.mechanical.items():
        size = trial.sizes[name]
        if not trial.is_noisy(name) or is_held(values[fresh]):
            continue
        chance = size.step / (2.0 * math.sqrt(math.pi) * size.noise)
        share = _repeats_where_it_rests(values[fresh], size.noise, chance)
        where = " where it rests"
        if share <= _MOST:
            where, (share, chance) = "", _beside_one_step(values[fresh], size.step)
            if share <= chance:
                continue
        yield Finding(
            "warning",
            name,
            f"{name} repeats its value in {100.0 * share:.2g} % of the rows{where}, its noise "
            f"would in {100.0 * chance:.2g} %: as behind a median filter",
            "record the channel without the filter",
        )


def _repeats_where_it_rests(values: Floats, noise: float, chance: float) -> float:
    """Return the usual share of repeats in the blocks of rows in which a channel changes least."""
    blocks = values[: values.size // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    if blocks.shape[0] < _FEWEST_BLOCKS:
        return 0.0
    spans = np.ptp(blocks, axis=1)
    calm = blocks[spans <= np.quantile(spans, _CALM)]
    if calm.shape[0] < _FEWEST_BLOCKS or float(np.median(np.ptp(calm, axis=1))) < noise:
        return 0.0
    return float(np.median(np.mean(np.diff(calm, axis=1) == 0.0, axis=1))) - _MORE * chance


def _beside_one_step(values: Floats, step: float) -> tuple[float, float]:
    """Return the share of repeats and that of changes by one step; (0, 0) where they are alike.

    A clipped channel repeats its values too, but at one end: both halves of the span have to.
    """
    if step == 0.0:
        return 0.0, 0.0
    steps = np.rint(np.diff(values) / step)
    high = values[1:] > 0.5 * (np.nanmin(values) + np.nanmax(values))
    for half in (steps[high], steps[~high]):
        if half.size == 0:
            return 0.0, 0.0
        repeats, one = np.mean(half == 0.0), 0.5 * np.mean(np.abs(half) == 1.0)
        deviation = math.sqrt((repeats + 0.5 * one) / half.size)
        if not 0.0 < one < min(repeats / _ONE_STEP, repeats - _DEVIATIONS * deviation):
            return 0.0, 0.0
    return float(np.mean(steps == 0.0)), 0.5 * float(np.mean(np.abs(steps) == 1.0))


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
            yield Finding(
                "warning",
                name,
                f"{name} changes only every {np.median(rows):.0f} rows (zero-order hold)",
                "record the channel at its own rate, or correct for half an update of delay",
            )
