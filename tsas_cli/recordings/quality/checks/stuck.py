"""A channel does not change at all while the motion goes back and forth.

The sensor, its cable or its software hangs. A noisy channel is stuck if it does not change for 20
updates during visible motion; a noiseless one only if the drive crosses most of its span and
returns, because the distal end also rests in a dead band.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark, Severity
from tsas_cli.recordings.quality.samples import alternates, plateaus, rows_between_changes
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_FEWEST_UPDATES = 20
_LEAST_NOISE = 1e-4  # of the span; less may be interpolation of a computed channel


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the longest stuck stretch of each displacement and tension."""
    for name, values in trial.mechanical.items():
        if name == trial.prescribed:
            yield CannotTell(f"{name} is prescribed by the load, and may rest")
            continue
        if trial.sizes[name].lowest == trial.sizes[name].highest:
            yield _remark("warning", trial, name, slice(0, values.size))
            continue
        between = rows_between_changes(values)
        shortest = int(_FEWEST_UPDATES * np.median(between)) if between.size else _FEWEST_UPDATES
        long = plateaus(values, shortest)
        noisy = bool(long) and _noisy(trial, name, long)
        stuck = [rows for rows in long if _hangs(trial, name, rows, noisy=noisy)]
        if stuck:
            yield _remark("error", trial, name, max(stuck, key=lambda r: r.stop - r.start))


def _remark(severity: Severity, trial: RunSignals, name: str, rows: slice) -> Remark:
    begin, end = trial.time_s[rows.start], trial.time_s[rows.stop - 1]
    return Remark(
        severity,
        f"{name} does not change from {begin:.6g} s to {end:.6g} s "
        f"(it stays at {trial.channels[name][rows.start]:.6g})",
        "check the sensor and its cable, and leave the column or this stretch out",
        name,
        float(begin),
    )


def _hangs(trial: RunSignals, name: str, rows: slice, *, noisy: bool) -> bool:
    values = trial.channels[name]
    interior = trial.sizes[name].lowest < values[rows.start] < trial.sizes[name].highest
    for other in trial.references(name):
        motion = trial.channels[other][rows]
        motion = motion[np.isfinite(motion)]
        if motion.size < 2:
            continue
        if interior and noisy and np.ptp(motion) > 2.0 * trial.visible(other):
            return True
        if _crosses_and_returns(motion, trial.sizes[other].span):
            return True
    return False


def _noisy(trial: RunSignals, name: str, long: list[slice]) -> bool:
    """Return whether the noise exceeds the quantisation outside the long plateaus."""
    values = trial.channels[name].copy()
    for rows in long:
        values[rows] = np.nan
    least = max(trial.sizes[name].step, _LEAST_NOISE * trial.sizes[name].span)
    return alternates(values) and noise_sd(values) > least


def _crosses_and_returns(motion: Floats, span: float) -> bool:
    strokes = np.abs(np.diff(motion[turning_points(motion, 0.2 * span)]))
    return bool(np.ptp(motion) > 0.6 * span and strokes.sum() > 1.5 * span)


CHECK = QualityCheck("stuck", find)
