"""The checks of channels whose sizes or times must agree."""

import math
from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_LENGTHS = {10.0: "centimetre", 25.4: "inch", 1000.0: "metre"}  # in mm
_FORCES = {4.448: "pound-force", 9.807: "kilogram-force", 1000.0: "kilonewton"}  # in N


def _ratios(lower: str, upper: str, units: Mapping[float, str]) -> dict[float, str]:
    """Return what the ratio of two channels is if one of them is in another unit."""
    return {1.0 / size: f"{upper} looks like {unit}" for size, unit in units.items()} | {
        size: f"{lower} looks like {unit}" for size, unit in units.items()
    }


_TRAVEL = _ratios("x_in_mm", "x_out_mm", _LENGTHS) | {
    2.0: "x_in_mm looks like taken with the radius of a wheel for its diameter"
}
_TENSION = _ratios("f_in_N", "f_out_N", _FORCES)
_STIFFNESS = {
    1 / 4.448: "f_out_N looks like pound-force",
    1 / 5.710: "load_stiffness_N_per_mm looks like pound-force per inch",
    1 / 10: "f_out_N looks like kilogram-force, or load_stiffness_N_per_mm like N/cm",
    1 / 1000: "f_out_N looks like kilonewton, or load_stiffness_N_per_mm like N/m",
    0.5: "x_out_mm looks like taken with the diameter of a wheel for its radius, or half of the "
    "load's springs are stated",
    2.0: "x_out_mm looks like taken with the radius of a wheel for its diameter, or one of two "
    "springs is stated",
    **{size: f"x_out_mm looks like {unit}" for size, unit in _LENGTHS.items()},
}
_TWICE = 1.2  # factor within which x_in is taken for twice what it is
_STRETCH = 10.0  # times what the whole tendon stretches by at the largest change of the tension
_SAME = 1.25  # factor within which a slope agrees with the stated one
_APART = 5.0  # factor beyond which one of two tensions is wrong
_FARTHER = 1.2  # travel of the load's end over the drive's, beyond which a scale is wrong
_COPY = 0.98  # correlation above which one path is a scaled copy of the other
_SLOW_S, _LONG_S = 0.2, 500.0  # a sample interval and a stroke that are normal in milliseconds
_FAST_S, _SHORT_S = 5e-5, 0.02  # a sample interval and a stroke that are normal, divided by 1000
_HOT_C = 200.0  # no rig is; a room in kelvin is


def unit(trial: RunSignals) -> Findings:
    """A channel is off by the ratio of two units: most likely its unit is not that in its name.

    Pairs that must agree are compared: the travel of the tendon's two ends; the level of the two
    tensions (their ratio is averaged geometrically over both directions, which cancels friction);
    the slope of `f_out_N` over `x_out_mm` with the data sheet's load stiffness; the sample interval
    with the duration of the strokes; a temperature with that of a room. A slope that is off by no
    known unit is a wrong gain or a wrong data sheet, as are tensions further apart; a load's end
    that travels further than the drive's has a wrong scale. A wide dead band also reduces the
    distal travel, but then the distal path is no scaled copy of the proximal one.
    """
    interval = trial.step_s
    if trial.increases and interval >= _SLOW_S and trial.stroke_s > _LONG_S:
        yield error(
            "time_s",
            f"one sample each {interval:.4g} s and {trial.stroke_s:.4g} s per stroke; "
            f"time_s looks like {'microsecond' if interval >= 1000.0 * _SLOW_S else 'millisecond'}",
            "check the unit of time_s and set it at ingest",
        )
    if trial.increases and interval <= _FAST_S and trial.stroke_s < _SHORT_S:
        taken = "microseconds" if interval <= _FAST_S / 1000.0 else "milliseconds"
        yield error(
            "time_s",
            f"one sample each {interval:.4g} s and {trial.stroke_s:.4g} s per stroke; time_s looks "
            f"like seconds taken for {taken}",
            "check the unit of time_s and set it at ingest",
        )
    if "temperature_C" in trial.channels:
        level = float(np.nanmedian(trial.channels["temperature_C"]))
        if level > _HOT_C:
            yield warning(
                "temperature_C",
                f"temperature_C is {level:.4g} °C; temperature_C looks like kelvin",
                "check the unit of temperature_C and set it at ingest",
            )
    tension, stiffness = _tension_ratio(trial), _slope_ratio(trial)
    travel, farther = None, 0.0
    driven = trial.recording.run.load == "displacement"
    if trial.strokes and not driven and "x_out_mm" in trial.channels:
        travel = _slope(trial, "x_in_mm", "x_out_mm")
        farther = trial.sizes["x_out_mm"].span / trial.sizes["x_in_mm"].span
    if travel is None and tension is None and stiffness is None and farther <= _FARTHER:
        yield NotChecked("no two channels whose sizes must agree were recorded and move")
    moves = "x_out_mm moves {:.4g} mm per mm of x_in_mm"
    of_travel = [*_suspect_unit(travel, moves, _TRAVEL, 1.4), *_halved(trial, travel)]
    yield from of_travel
    if farther > _FARTHER and not of_travel:
        yield warning(
            "x_out_mm",
            f"x_out_mm moves {farther:.3g} times as far as x_in_mm; a tendon moves its load less",
            "check unit and pulley radius of both; of a joint or a tip, the arm that moves it",
        )
    ratio = "f_out_N is {:.4g} times f_in_N"
    of_tension = list(_suspect_unit(tension, ratio, _TENSION, 1.15))
    for remark in of_tension:
        if remark.column != "f_out_N" or not _as_stated(stiffness):
            yield remark
    if tension is not None and abs(math.log(tension)) > math.log(_APART) and not of_tension:
        yield warning(
            "f_in_N",
            f"{ratio.format(tension)} in the mean of both directions, in which friction cancels",
            "check unit and gain of f_in_N and f_out_N",
        )
    slope = "the slope of f_out_N over x_out_mm is {:.4g} times load_stiffness_N_per_mm"
    suspected = list(_suspect_unit(stiffness, slope, _STIFFNESS, 1.1))
    yield from suspected
    if stiffness is not None and not suspected and not _as_stated(stiffness):
        yield warning(
            None,
            slope.format(stiffness),
            "check unit and gain of f_out_N and x_out_mm, and load_stiffness_N_per_mm",
        )


def duplicate_channel(trial: RunSignals) -> Findings:
    """Two channels are the same column, written twice.

    Two sensors never share their noise. A channel without noise of a sensor is not judged: without
    friction two simulated tensions are the same.
    """
    noisy = [name for name in trial.mechanical if trial.is_noisy(name)]
    for one, other in combinations(noisy, 2):
        if np.array_equal(trial.channels[one], trial.channels[other], equal_nan=True):
            yield error(
                other,
                f"{other} is a copy of {one}: all values are the same",
                f"check the columns of {one} and {other} in the map, then ingest again",
            )


def _halved(trial: RunSignals, travel: float | None) -> Iterator[Finding]:
    """Yield that x_in is twice what it is, where the tendon cannot stretch by what is lost."""
    sheet, run, forces = trial.rig, trial.recording.run, trial.sizes.get("f_in_N")
    modulus, diameter = sheet.tendon_modulus_GPa, sheet.tendon_diameter_mm
    length = run.sheath_length_mm
    if travel is None or not 0.5 / _TWICE < travel < 0.5 * _TWICE:
        return
    if forces is None or modulus is None or diameter is None or length is None:
        return
    stiffness_N = 1e3 * modulus * math.pi * diameter**2 / 4.0
    lost = (1.0 - travel) * trial.sizes["x_in_mm"].span
    if lost > _STRETCH * forces.span * length / stiffness_N:
        yield error(
            "x_in_mm",
            f"x_out_mm moves {travel:.4g} mm per mm of x_in_mm, and the tendon cannot stretch by "
            f"the {lost:.3g} mm that are lost; x_in_mm looks like taken with the diameter of a "
            "wheel for its radius",
            "check the radius that x_in_mm was calculated with, and set it at ingest",
        )


def _as_stated(stiffness: float | None) -> bool:
    """Return whether f_out over x_out has the slope of the stated spring, so that f_out is right.

    The drive may act on something else too, such as a spring to ground.
    """
    return stiffness is not None and abs(math.log(stiffness)) < math.log(_SAME)


def _suspect_unit(
    ratio: float | None, sentence: str, likely: Mapping[float, str], tolerance: float
) -> Iterator[Finding]:
    """Yield a remark if a ratio is close to the ratio of two units."""
    if ratio is None or not 0.0 < ratio < math.inf:
        return
    nearest = min(likely, key=lambda factor: abs(math.log(ratio / factor)))
    if abs(math.log(ratio / nearest)) < math.log(tolerance):
        column = likely[nearest].split()[0]
        yield error(
            None if column.startswith("load") else column,
            f"{sentence.format(ratio)}; {likely[nearest]}",
            f"check the unit of {column} and set it at ingest",
        )


def _tension_ratio(trial: RunSignals) -> float | None:
    """Return the level of f_out over f_in, averaged geometrically over the two directions."""
    if not trial.strokes or not {"f_in_N", "f_out_N"} <= trial.channels.keys():
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = trial.channels["f_out_N"] / trial.channels["f_in_N"]
    levels = []
    for direction in (1, -1):
        every = ratio[trial.direction == direction]
        levels.append(float(np.nanmedian(every)) if np.isfinite(every).any() else 0.0)
    return math.sqrt(levels[0] * levels[1]) if min(levels) > 0.0 else None


def _slope_ratio(trial: RunSignals) -> float | None:
    """Return the slope of f_out over x_out divided by the data sheet's load stiffness."""
    nominal = trial.rig.load_stiffness_N_per_mm if trial.on_spring else None
    if nominal is None or not {"x_out_mm", "f_out_N"} <= trial.channels.keys():
        return None
    slope = _slope(trial, "x_out_mm", "f_out_N")
    return slope / nominal if slope is not None else None


def _slope(trial: RunSignals, x: str, y: str) -> float | None:
    """Return the magnitude of the slope of y over x; None if they are not correlated."""
    both = np.isfinite(trial.channels[x]) & np.isfinite(trial.channels[y])
    a, b = trial.channels[x][both], trial.channels[y][both]
    if a.size < 3 or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return None
    if abs(float(np.corrcoef(a, b)[0, 1])) < _COPY:
        return None
    return float(np.std(b) / np.std(a))


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
