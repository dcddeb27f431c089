"""The fit of the nominal parameters, with initial values from the phases and the data sheet."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import FitProblem, prepare_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.phases import Segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.transfer import Slope, slopes
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

FAR = 1.0  # strokes: a zero that a fit from 0 mm does not find
SMALLEST_BEND = 1e-3  # rad
RARE = 0.05  # share of the samples on either side of what a ratio of tensions mostly is
SMALLEST_WRAP = 0.01  # below it the residual is insensitive to friction


def initial_values_of(
    run: Prepared, segments: Sequence[Segment], slopes: Sequence[Slope], rig: Rig
) -> dict[str, float]:
    """Return the parameters of one run by the formulas of the static model.

    Friction from the ratio of the tensions in both directions, or of the slopes (Yang 2025, Eqs.
    7, 31, 32); the load spring from f_out over x_out, or from the slopes; the tendon from the
    dead band (29). Parameters that the channels do not determine are left out. `rig` is the run's
    own, as stated.
    """
    length, bend = rig.sheath_length_mm, max(rig.total_bend_rad, SMALLEST_BEND)
    km: dict[str, float] = {s.phase: abs(s.value) for s in slopes if s.value != 0.0}
    wrap = _wrap(run, segments, km)
    found: dict[str, float] = {}
    if wrap is not None:
        wrap = max(wrap, SMALLEST_WRAP)
        found["friction_coefficient"] = wrap / bend
        dead = [km[p] for p in ("dead_band_up", "dead_band_down") if p in km]
        if dead:
            found["tendon_stiffness_N"] = (
                float(np.mean(dead)) * length * math.tanh(0.5 * wrap) / wrap
            )
    if run.run.load == "spring":
        found |= _spring(run, segments, km)
    elif run.run.load == "displacement":
        found |= _zero_between(run, rig)
    plausible = {k: (QUANTITIES[k].lower, QUANTITIES[k].upper) for k in found}
    return {k: float(v) for k, v in found.items() if plausible[k][0] <= v <= plausible[k][1]}


def _samples(segments: Sequence[Segment], phase: str, values: Floats) -> Floats:
    parts = [values[s.rows] for s in segments if s.phase == phase]
    return np.concatenate(parts) if parts else np.zeros(0)


def _wrap(run: Prepared, segments: Sequence[Segment], km: dict[str, float]) -> float | None:
    f_in, f_out = run.channel("f_in_N"), run.channel("f_out_N")
    if f_in is not None and f_out is not None:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.log(f_in / f_out)
        up = _samples(segments, "contraction", ratio)
        down = _samples(segments, "loosening", ratio)
        if np.isfinite(up).any() and np.isfinite(down).any():
            return 0.5 * float(np.nanmedian(up) - np.nanmedian(down))
        known = ratio[np.isfinite(ratio)]
        if run.drive_column == "f_in_N" and known.size:  # a force has no phases
            return 0.5 * float(np.ptp(np.quantile(known, (RARE, 1.0 - RARE))))
    if "contraction" in km and "loosening" in km:
        return 0.5 * math.log(km["contraction"] / km["loosening"])
    return None


def _lowest_zeros(run: Prepared) -> dict[str, float]:
    """Return zeros where the drive lets go furthest: no force shows where the tendon is slack."""
    x_in = run.channel("x_in_mm")
    if x_in is None or not np.isfinite(x_in).any():
        return {}
    lowest = int(np.nanargmin(x_in))
    readings = {name: run.channel(name) for name in ("x_in_mm", "x_out_mm")}
    return {
        name.replace("_mm", "_zero_mm"): float(x[lowest])
        for name, x in readings.items()
        if x is not None and np.isfinite(x[lowest])
    }


def _spring(run: Prepared, segments: Sequence[Segment], km: dict[str, float]) -> dict[str, float]:
    """Return the load's spring, the preload and zeros, by the line of a force over a displacement.

    Of f_out, else f_in, over x_out; else of f_out over x_in; else of f_in over x_in, in both
    directions; without any force the zeros alone.
    """
    f_out, x_out, x_in = (run.channel(name) for name in ("f_out_N", "x_out_mm", "x_in_mm"))
    force = run.channel("f_in_N") if f_out is None else f_out
    at_load = _line(x_out, force)
    if at_load is not None and force is not None and x_out is not None:
        slope, intercept = at_load
        found = {"load_stiffness_N_per_mm": slope, "preload_N": intercept}
        if slope > 0.0:
            first = float(x_out[np.isfinite(force) & np.isfinite(x_out)][0])
            found |= _far_zeros(run, force, first, slope, intercept)
        return found
    over_drive = _line(x_in, f_out)
    if over_drive is not None and over_drive[0] > 0.0 and f_out is not None:
        slope, intercept = over_drive
        return {"load_stiffness_N_per_mm": slope} | _at_drive(run, f_out, [slope], [intercept])
    if "contraction" not in km or "loosening" not in km:
        return {} if run.has_force else _lowest_zeros(run)
    found = {"load_stiffness_N_per_mm": math.sqrt(km["contraction"] * km["loosening"])}
    f_in = run.measured.get("f_in_N")
    if f_in is not None and x_in is not None:
        both = km["contraction"], km["loosening"]
        lines = zip(("contraction", "loosening"), both, strict=True)
        at_zero = [
            float(np.nanmean(_samples(segments, p, f_in) - slope * _samples(segments, p, x_in)))
            for p, slope in lines
        ]
        found |= _at_drive(run, f_in, both, at_zero)
    return found


def _line(x: Floats | None, force: Floats | None) -> tuple[float, float] | None:
    """Return slope and intercept of a force over a displacement; None without both."""
    if x is None or force is None:
        return None
    ok = np.isfinite(force) & np.isfinite(x)
    if ok.sum() <= 2 or np.ptp(x[ok]) == 0.0:
        return None
    slope, intercept = map(float, np.polyfit(x[ok], force[ok], 1))
    return slope, intercept


def _at_drive(
    run: Prepared, force: Floats, slopes: Sequence[float], at_zero: Sequence[float]
) -> dict[str, float]:
    """Return the preload by the lines of a force over x_in, or the zero of x_in.

    The tensions at 0 mm are the preload, unless a tendon would be slack there: its zero is then
    where the lines are at the stated preload, or at the mean of the force.
    """
    if min(at_zero) > 0.0:
        return {"preload_N": math.exp(float(np.mean(np.log(at_zero))))}
    stated = run.run.preload_N
    preload = float(np.nanmean(force)) if stated is None else stated
    zeros = [(preload - at) / slope for slope, at in zip(slopes, at_zero, strict=True)]
    found = {"x_in_zero_mm": float(np.mean(zeros))}
    return found if stated is not None else found | {"preload_N": preload}


def _far_zeros(
    run: Prepared, force: Floats, first_mm: float, slope: float, intercept: float
) -> dict[str, float]:
    """Return zeros of displacements with a distant origin, and the preload with them.

    With zeros at 0 mm the spring would be slack where x_out reads 0 (the tension there is the
    `intercept` of its line), or the tendon within the run, from where a fit does not converge, as
    from many strokes away. The tendon's own stretch is neglected.
    """
    found = {}
    preload = intercept
    stroke = float(np.nanmax(force) - np.nanmin(force)) / slope
    if intercept <= 0.0 or abs(first_mm) > FAR * stroke:
        # the preload is then the stated one, or the run's initial tension
        stated = run.run.preload_N
        preload = intercept + slope * first_mm if stated is None else stated
        found = {"x_out_zero_mm": (preload - intercept) / slope, "preload_N": preload}
    if run.drive_column == "x_in_mm":
        x_in = run.conditioned["x_in_mm"].values
        zero = float(np.nanmedian(x_in - (force - preload) / slope))
        slack = float(np.min(x_in)) < -preload / slope
        if slack or abs(zero) > FAR * float(np.ptp(x_in)):
            found["x_in_zero_mm"] = zero
    return found


def _zero_between(run: Prepared, rig: Rig) -> dict[str, float]:
    """Return the zero of x_in where both ends are driven and the tendon would be slack with 0 mm.

    Two independent sensors are often offset by more than the tendon stretches.
    """
    tension = run.measured.get("f_in_N", run.measured.get("f_out_N"))
    if run.drive_column != "x_in_mm" or tension is None:
        return {}
    difference = run.conditioned["x_in_mm"].values - run.conditioned["x_out_mm"].values
    compliance = rig.sheath_length_mm / rig.tendon_stiffness_N
    if float(np.min(difference)) >= -rig.preload_N * compliance:
        return {}
    stretch = (tension - rig.preload_N) * compliance
    return {"x_in_zero_mm": float(np.nanmedian(difference - stretch))}


def base_fit(
    stated: Model,
    runs: Sequence[Prepared],
    segments: Sequence[list[Segment]],
    measured: Sequence[list[Slope]],
    plausible: Mapping[str, tuple[float, float]] | None = None,
) -> FitProblem:
    """Return the joint fit of all runs as a problem to solve.

    `stated` has the values of parameters that are fixed, those of the data sheet for example;
    `plausible` are narrower bounds of some.
    """
    initial = read_off(stated, runs, segments, measured)
    return prepare_fit(initial.over(stated), stated.over(initial), runs, plausible=plausible)


def slopes_of(
    run: Prepared, segments: list[Segment], predicted_N: Floats | None = None
) -> list[Slope]:
    """Return the stiffness km of a run's phases, none where f_in or x_in was not measured.

    With `predicted_N`, shape (n,), it is that of a prediction of f_in.
    """
    measured = run.measured.get("f_in_N")
    if measured is None or "x_in_mm" not in run.conditioned:
        return []
    f_in = measured if predicted_N is None else predicted_N
    return slopes(run.conditioned["x_in_mm"].values, f_in, segments)


def read_off(
    stated: Model,
    runs: Sequence[Prepared],
    segments: Sequence[list[Segment]],
    measured: Sequence[list[Slope]],
) -> Model:
    """Return initial values from the phases of the runs; the median where runs share one."""
    found: dict[tuple[str, str | None], list[float]] = {}
    for run, parts, km in zip(runs, segments, measured, strict=True):
        values = initial_values_of(run, parts, km, stated.rig(run.run))
        for name, value in values.items():
            owner = None if QUANTITIES[name].shared else run.run.id
            found.setdefault((name, owner), []).append(value)
    return Model(
        tuple(
            Estimate(name, float(np.median(values)), QUANTITIES[name].unit, "default", owner)
            for (name, owner), values in found.items()
        )
    )
