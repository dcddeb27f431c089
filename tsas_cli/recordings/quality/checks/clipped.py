"""A channel sits at its highest or lowest value while the motion goes on.

The sensor or its amplifier is at the end of its range, or the part is at a stop. Reported when the
channel stays constant at its extreme while the drive moves on by more than a twentieth of its span.
Not clipping: a dwell (everything rests), the dead band after a reversal (the drive moves back), a
coarse step at the peak of a sine, a rest at the beginning.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import plateaus
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

_FEWEST_ROWS = 5
_TRAVEL = 0.05  # of the drive's span


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the clipped extremes of each displacement and tension."""
    for name in trial.mechanical:
        if name == trial.prescribed:
            yield CannotTell(f"{name} is prescribed by the load, and may stay at its extremes")
            continue
        if trial.sizes[name].lowest == trial.sizes[name].highest:
            continue
        for end, sign in (("highest", 1), ("lowest", -1)):
            yield from _clipping(trial, name, end, sign)


def _clipping(trial: RunSignals, name: str, end: str, sign: int) -> Iterator[Remark]:
    values = trial.channels[name]
    extreme = trial.sizes[name].highest if sign > 0 else trial.sizes[name].lowest
    flat = [
        rows
        for rows in plateaus(values, _FEWEST_ROWS)
        if rows.start > 0
        and values[rows.start] == extreme
        and _motion_continues(trial, name, rows, sign)
    ]
    if flat:
        seconds = sum(trial.time_s[r.stop - 1] - trial.time_s[r.start] for r in flat)
        yield Remark(
            "error",
            f"{name} stays at its {end} value {extreme:.6g} for {seconds:.3g} s in "
            f"{count_of(len(flat), 'plateau')} while the motion goes on",
            "raise the sensor's range or lower its gain, check for a stop, and record again",
            name,
            float(trial.time_s[flat[0].start]),
        )


def _motion_continues(trial: RunSignals, name: str, rows: slice, sign: int) -> bool:
    """Return whether the motion continues beyond its position at the start of the plateau."""
    coarse = 4.0 * trial.sizes[name].step / max(trial.sizes[name].span, 1e-300)
    for other in trial.references(name):
        moved = sign * (trial.channels[other][rows] - trial.channels[other][rows.start])
        further = float(np.nanmax(moved, initial=0.0))
        needed = max(_TRAVEL, coarse) * trial.sizes[other].span + trial.visible(other)
        back = float(np.nanmin(moved, initial=0.0))
        if further > needed and -back < 0.6 * trial.sizes[other].span:
            return True
    return False


CHECK = QualityCheck("clipped", find)
