"""The checks for channels that repeat their own values."""

import math

import numpy as np

from tsas_cli.recordings.quality.finding import Findings, warning
from tsas_cli.recordings.quality.samples import is_held, rows_between_changes, smallest_change
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

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
