"""Samples that stand far off both their neighbours, one or a few in a row."""

import numpy as np

from tsas_cli.recordings.quality.samples import Booleans
from tsas_cli.recordings.recording import Floats

_MOST_IN_A_ROW = 3
_NOISE, _STEPS, _SPAN = 20.0, 10.0, 0.05  # how far off, in noise, in steps and in the span
_BESIDE = 16  # samples on either side whose own steps are looked at
_STEEPER = 10.0  # than those: motion that turns back within a few samples has steep neighbours
_COMMON = 0.02  # of all samples: what is as frequent as this is the signal


def outlying(
    time_s: Floats, values: Floats, *, most: float, noise: float, step: float, span: float
) -> Booleans:
    """Return which samples stand out, shape (n,).

    A sample does that no rig has, or that one, two or three of which lie off what is before and
    after them, both on the same side, by far more than noise, steps of quantisation and the motion
    beside them explain. A step that stays is none. The first and the last samples have one side
    only, so they have to lie off by more than the span.

    Parameters
    ----------
    time_s, values
        A channel, shape (n,) each; NaN where it is empty.
    most
        The largest size that a rig has [unit of the channel].
    noise, step, span
        Those of the whole channel [its unit]; NaN where the noise cannot be told.
    """
    with np.errstate(all="ignore"):  # a stray 1e300 stands out like any other
        found = np.abs(values) > most
        if not span > 0.0:  # one other value in a constant channel may be its step
            return found
        there = np.flatnonzero(np.isfinite(values) & ~found)
        # Beside a value of 1e9 the levels of the others are one, and the step is that value.
        steps = _STEPS * step if step <= span else 0.0
        least = max(_SPAN * span, steps, _NOISE * np.nan_to_num(noise))
        found[there[_standing_off(time_s[there], values[there], least, span)]] = True
    return found


def _standing_off(time_s: Floats, values: Floats, least: float, span: float) -> Booleans:
    """Return which of the samples that are there do."""
    found = np.zeros(values.size, dtype=np.bool_)
    if values.size <= 2 * _MOST_IN_A_ROW:
        return found
    apart = 1.5 * float(np.median(np.diff(time_s)))
    change = np.abs(np.diff(values))
    # What lies before the first sample and after the last is taken to be like the other side.
    before, after = np.r_[np.nan, values[:-1]], np.r_[values[1:], np.nan]
    lowest = highest = values  # of so many in a row
    for count in range(1, _MOST_IN_A_ROW + 1):
        if count > 1:
            lowest = np.minimum(lowest[:-1], values[count - 1 :])
            highest = np.maximum(highest[:-1], values[count - 1 :])
        left, right = before[: lowest.size], after[count - 1 :]
        above = lowest - np.fmax(left, right)
        below = np.fmin(left, right) - highest
        off = np.maximum(above, below)
        needed = np.full(off.size, least)
        needed[[0, -1]] = max(least, span)
        starts = np.flatnonzero(off > needed)
        if starts.size > _COMMON * values.size:
            continue
        for start in starts.tolist():
            stop = start + count
            long = np.diff(time_s[max(start - 1, 0) : stop + 1]) > apart
            beside = np.r_[
                change[max(start - 1 - _BESIDE, 0) : max(start - 1, 0)],
                change[stop : stop + _BESIDE],
            ]
            if not long.any() and off[start] > _STEEPER * beside.max(initial=0.0):
                found[start:stop] = True
    return found
