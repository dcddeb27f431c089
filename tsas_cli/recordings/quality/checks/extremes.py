"""The checks of a channel's range: its ends, its rests, its steps, its mean."""

import numpy as np

from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, Severity, error
from tsas_cli.recordings.quality.samples import (
    alternates,
    calm_noise,
    plateaus,
    rows_between_changes,
)
from tsas_cli.recordings.quality.trial import RunSignals

_ZERO = 0.15  # of the channel's span: the mean of the second half
_NEGATIVE = 0.2  # share of the samples there


def ac_coupled(trial: RunSignals) -> Findings:
    """A tension has no constant part: its amplifier passes changes alone.

    A tendon that pushes nowhere has a positive tension; behind a coupling to AC its mean falls to
    zero within the time constant of the coupling, and what is left is negative half of the time.
    Reported where the second half of a run has a mean near zero in both directions of the drive,
    though the manifest states a preload. A zero that was set under load is a constant offset: it
    leaves the mean where it was at the start.
    """
    preload = trial.recording.run.preload_N
    if not preload:
        yield NotChecked("no preload is stated")
        return
    for name in ("f_in_N", "f_out_N"):
        if name not in trial.channels:
            continue
        values = trial.channels[name]
        late = values[values.size // 2 :]
        span = trial.sizes[name].span
        began = float(np.nanmean(values[: trial.strokes[0].stop + 1]))
        mean = float(np.nanmean(late))
        if abs(mean) < _ZERO * span < began and np.nanmean(late < 0.0) > _NEGATIVE:
            yield error(
                name,
                f"{name} begins at {began:.3g} N and has a mean of {mean:.2g} N in the second half "
                f"of the run, with a preload of {preload:g} N: its amplifier is coupled to AC",
                "set the amplifier to DC and record again",
            )


_FEWEST_UPDATES = 20
_MARGIN = 0.1  # of the rows of a plateau, at either end
_MOVES_WITH = {
    "f_in_N": ("f_out_N", "x_in_mm"),
    "f_out_N": ("x_out_mm",),
    "x_out_mm": ("f_out_N",),
}
_LEAST_NOISE = 1e-4  # of the span; less may be interpolation of a computed channel


def stuck(trial: RunSignals) -> Findings:
    """A channel does not change, or by its noise alone, while the motion goes back and forth.

    The sensor, its cable or its software hangs. A channel with noise in its calm rows is stuck if
    it does not change for 20 updates during visible motion; one without only if the drive crosses
    most of its span and returns, because the distal end also rests in a dead band, and a drive that
    hunts within a step of its encoder moves the tension. With a spring as load f_out moves with
    x_out, and f_in with both: noise alone is a sensor that is dead, or not connected.
    """
    for name, values in trial.mechanical.items():
        if name == trial.prescribed:
            yield NotChecked(f"{name} is prescribed by the load, and may rest")
            continue
        if trial.sizes[name].lowest == trial.sizes[name].highest:
            yield _unchanging("warning", trial, name, slice(0, values.size))
            continue
        moving = [other for other in _MOVES_WITH.get(name, ()) if other in trial.channels]
        if trial.on_spring and not trial.moves(name) and any(map(trial.moves, moving)):
            with_x_in_alone = not any(trial.moves(other) for other in moving if other != "x_in_mm")
            yield _dead("warning" if with_x_in_alone else "error", trial, name)
            continue
        between = rows_between_changes(values)
        shortest = int(_FEWEST_UPDATES * np.median(between)) if between.size else _FEWEST_UPDATES
        long = plateaus(values, shortest)
        noisy = bool(long) and _noisy(trial, name, long)
        stuck = [rows for rows in long if _hangs(trial, name, rows, noisy=noisy)]
        if stuck:
            yield _unchanging("error", trial, name, max(stuck, key=lambda r: r.stop - r.start))


def _unchanging(severity: Severity, trial: RunSignals, name: str, rows: slice) -> Finding:
    begin, end = trial.time_s[rows.start], trial.time_s[rows.stop - 1]
    return Finding(
        severity,
        name,
        f"{name} does not change from {begin:.6g} s to {end:.6g} s "
        f"(it stays at {trial.channels[name][rows.start]:.6g})",
        "check the sensor and its cable, and leave the column or this stretch out",
        float(begin),
    )


def _dead(severity: Severity, trial: RunSignals, name: str) -> Finding:
    unit = name.rsplit("_", 1)[1]
    return Finding(
        severity,
        name,
        f"{name} shows its noise alone while the drive moves (it stays at "
        f"{float(np.nanmean(trial.channels[name])):.4g} {unit})",
        "check the sensor and its cable, and leave the column out",
    )


def _hangs(trial: RunSignals, name: str, rows: slice, *, noisy: bool) -> bool:
    """Return whether another channel moves while this one does not change.

    The ends of the time are left out: within a step of x_in the tension may have begun to move.
    """
    values, margin = trial.channels[name], int(_MARGIN * (rows.stop - rows.start))
    interior = trial.sizes[name].lowest < values[rows.start] < trial.sizes[name].highest
    for other in trial.references(name):
        motion = trial.channels[other][rows.start + margin : rows.stop - margin]
        motion = motion[np.isfinite(motion)]
        if motion.size < 2:
            continue
        if interior and noisy and np.ptp(motion) > 2.0 * trial.visible(other):
            return True
        span = trial.sizes[other].span
        strokes = np.abs(np.diff(motion[turning_points(motion, 0.2 * span)]))
        if np.ptp(motion) > 0.6 * span and strokes.sum() > 1.5 * span:  # it crosses and returns
            return True
    return False


def _noisy(trial: RunSignals, name: str, long: list[slice]) -> bool:
    """Return whether the noise exceeds the quantisation outside the long plateaus.

    Noise of a sensor is there in the calmest rows too, where a motion leaves nothing in its place.
    """
    values = trial.channels[name].copy()
    for rows in long:
        values[rows] = np.nan
    least = max(trial.sizes[name].step, _LEAST_NOISE * trial.sizes[name].span)
    return alternates(values) and calm_noise(values) > least


_NOTE, _WARNING = 1 / 500, 1 / 50


def quantised(trial: RunSignals) -> Findings:
    """A channel moves in steps that are coarse for its noise and its range.

    A note if the step is more than twice the noise, so that averaging does not resolve it, and more
    than a 500th of the range; a warning from a 50th of the range on.
    """
    for name in trial.mechanical:
        step, noise, span = trial.sizes[name].step, trial.sizes[name].noise, trial.sizes[name].span
        if step <= max(2.0 * noise, _NOTE * span) or span == 0.0:
            continue
        coarse = step > _WARNING * span and name != trial.prescribed
        unit = name.rsplit("_", 1)[1]
        yield Finding(
            "warning" if coarse else "note",
            name,
            f"{name} moves in steps of {step:.4g} {unit}, {100 * step / span:.2g} % of its range "
            f"of {span:.4g} {unit}; its noise is {noise:.2g} {unit}",
            "use a finer resolution or a smaller measuring range, if residuals below a step matter",
        )
