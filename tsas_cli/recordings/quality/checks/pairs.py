"""The checks of channels whose sizes must agree."""

import math
from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np

from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.trial import RunSignals

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
