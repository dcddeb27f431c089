"""The check of two channels whose times must agree: tension and displacement at the load."""

import math

import numpy as np

from tsas_cli.recordings.quality.finding import Findings, NotChecked, warning
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_MOST_CYCLES = 100  # evenly spread; more would not improve the estimate
_ROUNDS = 20
_ROWS = 40  # least number of independent rows of a smoothed cycle
_SLOW = 0.3  # of the RMS speed: below, noise decides its sign
_SPRING = 0.002  # largest share of the tension's variance that a spring leaves unexplained
_OWN = 0.02  # least share of the speed that the other terms leave unexplained


def delay(trial: RunSignals) -> Findings:
    """The tension at the load comes before or after the displacement at the load.

    A spring's tension follows its displacement without lag, so a time shift between the two is an
    artefact of the recording: filters, another bus, another clock. It is fitted cycle by cycle,
    together with the spring's curvature and a friction at the load, and reported when the cycles
    agree and it matters: above half a sample, and with an error of the tension above a quarter of
    the noise. Other pairs of channels lag by the physics of the sheath and are not judged. A load
    with a damper, a mass or hysteresis, or one that relaxes, looks like a tension that comes before
    the displacement.
    """
    strokes = zip(trial.strokes[::2], trial.strokes[1::2], strict=False)
    cycles = [slice(one.start, other.stop + 1) for one, other in strokes]
    cycles = cycles[:: max(1, -(-len(cycles) // _MOST_CYCLES))]
    delays = np.array([d for d in (_delay(trial, rows) for rows in cycles) if math.isfinite(d)])
    if delays.size < 2:
        yield NotChecked("fewer than two cycles of changing speed with a load like a spring")
        return
    from scipy.special import stdtrit

    mean, quantile = float(delays.mean()), float(stdtrit(delays.size - 1, 0.975))
    half = quantile * float(delays.std(ddof=1)) / math.sqrt(delays.size)  # each cycle is one
    force = trial.channels["f_out_N"]
    rate = np.nanstd(force) * math.pi * len(trial.strokes) / np.ptp(trial.time_s)
    matters_s = max(0.5 * trial.step_s, 0.25 * trial.sizes["f_out_N"].noise / float(rate))
    if abs(mean) - half > matters_s:
        yield warning(
            "f_out_N",
            f"f_out_N comes {1e3 * abs(mean):.3g} ms (95 %: {1e3 * (abs(mean) - half):.3g} to "
            f"{1e3 * (abs(mean) + half):.3g}) {'after' if mean > 0 else 'before'} x_out_mm",
            "use the same filter and clock for both channels, or shift one at the source (offset_s "
            "in a .join list)"
            + ("" if mean > 0 else ", unless the load relaxes, has a damper, a mass or hysteresis"),
        )


def _delay(trial: RunSignals, rows: slice) -> float:
    """Return the delay of f_out behind x_out in one cycle [s]; NaN if it is not identifiable."""
    x, y = (trial.channels[name][rows] for name in ("x_out_mm", "f_out_N"))
    time = trial.time_s[rows]
    valid = np.isfinite(x) & np.isfinite(y)
    width = max(int(valid.sum()) // _ROWS, 1)
    if valid.sum() < 2 * _ROWS or np.ptp(x[valid]) < 2.0 * trial.visible("x_out_mm"):
        return math.nan
    mean = np.ones(width) / width
    x, y, time = (np.convolve(values[valid], mean, mode="valid") for values in (x, y, time))
    longest = 0.25 * float(time[-1] - time[0])
    delay = 0.0
    for _ in range(_ROUNDS):
        inside = (time - delay >= time[0]) & (time - delay <= time[-1])
        shifted = np.interp(time - delay, time, x)
        change = _remaining_delay(time[inside], shifted[inside], y[inside])
        delay += change
        if not abs(delay) < longest:
            return math.nan
        if abs(change) < 1e-3 * float(time[1] - time[0]):
            return delay
    return math.nan


def _remaining_delay(time: Floats, x: Floats, y: Floats) -> float:
    """Return −c/b of y = a + b x + d x² + e sgn(v) + c v.

    NaN if the speed is a combination of the other terms, or the terms do not explain the tension.
    """
    speed = np.gradient(x, time)
    moving = np.abs(speed) > _SLOW * np.sqrt(np.mean(speed**2))
    if moving.sum() < _ROWS // 2:
        return math.nan
    x, y, speed = x[moving] - x[moving].mean(), y[moving], speed[moving]
    others = np.column_stack([np.ones_like(x), x, x**2, np.sign(speed)])
    own = speed - others @ np.linalg.lstsq(others, speed, rcond=None)[0]
    if np.sum(own**2) < _OWN * np.sum(speed**2):
        return math.nan
    terms = np.column_stack([others, speed])
    coefficients = np.linalg.lstsq(terms, y, rcond=None)[0]
    if np.var(y - terms @ coefficients) > _SPRING * np.var(y):
        return math.nan
    return float(-coefficients[4] / coefficients[1])
