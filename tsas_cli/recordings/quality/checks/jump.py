"""The check for a position that jumps alone."""

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Remark, Remarks
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_FAR = 10.0  # times the largest step elsewhere
_NOISE, _STEPS = 20.0, 3.0  # noise levels and quantisation steps
_QUIET = 3.0  # times the largest step elsewhere, of a channel that does not jump
_BESIDE = 2  # rows


def jump(trial: RunSignals) -> Remarks:
    """A position jumps from one row to the next and stays there, and no other channel jumps.

    An encoder was reset, its counter overflowed, or its cable was off for a moment. Reported where
    x_in or x_out changes by ten times its largest change elsewhere, 20 times its noise and three
    quantisation steps, while all other channels change as they do elsewhere. Not reported: an
    outlier, which comes back; a drive that jumps, which the tension follows; a tendon that slips
    many times. A jump within the usual changes is a fault that `diagnose` names.
    """
    channels = {name: trial.steps(name) for name in trial.mechanical}
    for name in ("x_in_mm", "x_out_mm"):
        if name not in channels:
            continue
        if len(channels) < 2:
            yield CannotTell("no other channel shows whether the tendon moved")
            continue
        at = int(np.argmax(channels[name]))
        beside = slice(max(at - _BESIDE, 0), at + _BESIDE + 1)
        size, elsewhere = channels[name][at], _elsewhere(channels[name], beside)
        sizes = trial.sizes[name]
        least = max(_FAR * elsewhere, _NOISE * sizes.noise, _STEPS * sizes.step)
        others = [steps for other, steps in channels.items() if other != name]
        alone = all(steps[beside].max() <= _QUIET * _elsewhere(steps, beside) for steps in others)
        if size > least and alone:
            before, after = trial.channels[name][at : at + 2]
            yield Remark(
                "error",
                f"{name} jumps from {before:.6g} to {after:.6g} mm at {trial.time_s[at + 1]:.6g} "
                f"s, row {trial.first_row + at + 1}, and no other channel jumps there",
                "check the encoder, its counter and its cable; record again, or end the run before",
                name,
                float(trial.time_s[at + 1]),
            )


def _elsewhere(steps: Floats, beside: slice) -> float:
    """Return the largest change, but for those beside a row."""
    rest = steps.copy()
    rest[beside] = 0.0
    return float(rest.max(initial=0.0))
