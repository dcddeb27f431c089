"""A channel at the load jumps whenever the drive reverses.

In the dead band after a reversal of the drive the load rests, so nothing there can jump with it.
What does is an interference that follows the direction of the motor: its current in the cable of a
sensor, or a correction by the sign of the speed. Beside it f_in may jump too; that looks like
friction of the drive.
"""

import math
from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_BESIDE_S, _OF_A_STROKE = 0.4, 0.06  # stretch on either side, at most
_APART = 0.3  # of it: the time of the reversal itself
_FEWEST_ROWS, _FEWEST_REVERSALS = 6, 4
_RESTS = 1.5  # noise levels of a change while the load rests
_PART = 0.2  # of a jump, that it may change by then
_VISIBLE, _CRITICAL = 4.0, 6.0  # noise levels, and standard errors of the mean


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels that jump with the direction of the drive."""
    spring = trial.recording.run.load == "spring"
    if (
        not spring
        or not trial.increases
        or trial.batches is not None
        or len(trial.strokes) <= _FEWEST_REVERSALS
    ):
        yield CannotTell(
            "the load is no spring, the times are uneven, or the drive has too few reversals"
        )
        return
    for name in ("x_out_mm", "f_out_N"):
        values = trial.channels.get(name)
        if values is None or not trial.is_noisy(name) or not np.isfinite(values).all():
            continue
        jumps = _jumps(trial, values, trial.sizes[name].noise)
        if jumps.size < _FEWEST_REVERSALS:
            continue
        mean, error = float(jumps.mean()), float(jumps.std(ddof=1)) / math.sqrt(jumps.size)
        if abs(mean) > max(_VISIBLE * trial.sizes[name].noise, _CRITICAL * error):
            unit = name.rsplit("_", 1)[1]
            yield Remark(
                "error",
                f"{name} jumps by {abs(mean):.2g} {unit} when the drive reverses, "
                "where the load still rests: interference that follows the motor's direction",
                "shield the sensor's cable from the motor's, and look for corrections by the sign "
                "of the speed",
                name,
            )


def _jumps(trial: RunSignals, values: Floats, noise: float) -> Floats:
    """Return the jump of a channel at each reversal after which it rests, with the drive."""
    found = []
    for old, new in zip(trial.strokes, trial.strokes[1:], strict=False):
        if old.stop != new.start or old.direction == new.direction:
            continue
        lasts = min(trial.time_s[s.stop] - trial.time_s[s.start] for s in (old, new))
        beside_s = min(_BESIDE_S, _OF_A_STROKE * lasts)
        t = (trial.time_s - trial.time_s[old.stop]) / beside_s
        after, before = (t > _APART) & (t < 1.0 + _APART), (t < -_APART) & (t > -1.0 - _APART)
        if min(after.sum(), before.sum()) < _FEWEST_ROWS:
            continue
        slope, level = _polynomial(t[after], values[after], 1)
        jump = level - _polynomial(t[before], values[before], 2)[-1]
        if abs(slope) < max(_RESTS * noise, _PART * abs(jump)):
            found.append(new.direction * jump)
    return np.array(found)


def _polynomial(t: Floats, values: Floats, degree: int) -> Floats:
    return np.asarray(np.linalg.lstsq(np.vander(t, degree + 1), values, rcond=None)[0])


CHECK = QualityCheck("interference", find, needs=("x_in_mm",))
