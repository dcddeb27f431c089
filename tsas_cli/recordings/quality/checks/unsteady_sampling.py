"""The samples were taken at other times than those that are written down.

A busy computer reads its sensors early and late, and writes even times. Each channel then has noise
in proportion to its speed, all by the same time. Reported where the noise of two channels more than
doubles from slow to fast motion, by times that agree.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_BLOCK = 16  # rows
_FEWEST_BLOCKS = 30
_MEDIAN_OF_THIRD = 0.6745 * np.sqrt(20.0)  # of |third difference|, for noise of unit deviation
_SLOW, _FAST = 0.3, 0.7  # quantiles of the speed
_TIMES = 2.0  # the noise of slow motion
_ALIKE = 1.5  # ratio of two times at most


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the scatter of the sampling times that two channels agree on."""
    if not trial.increases:
        yield CannotTell("time does not increase")
        return
    found: dict[str, float] = {}
    for name, values in trial.mechanical.items():
        if trial.moves(name) and trial.is_noisy(name) and np.isfinite(values).all():
            scatter_s = _scatter_s(trial.time_s, values)
            if scatter_s is not None:
                found[name] = scatter_s
    sizes = sorted(found.values())
    pairs = [b for a, b in pairwise(sizes) if b < _ALIKE * a]
    if pairs:
        yield Remark(
            "error",
            f"the noise of {' and '.join(found)} grows with the speed as if the samples were "
            f"taken {1e3 * pairs[0]:.2g} ms (RMS) early or late",
            "record with the clock of the data acquisition, or write down the time of each sample",
        )


def _scatter_s(time_s: Floats, values: Floats) -> float | None:
    """Return the scatter of the times that explains a channel's noise [s]; None if none does."""
    count = (values.size - 3) // _BLOCK
    if count < _FEWEST_BLOCKS:
        return None
    third = np.abs(np.diff(values, 3))[: count * _BLOCK].reshape(count, _BLOCK)
    noise = np.median(third, axis=1) / _MEDIAN_OF_THIRD
    ends = _BLOCK * np.arange(count + 1)
    speed = np.abs(np.diff(values[ends]) / np.diff(time_s[ends]))
    slow, fast = np.quantile(speed, (_SLOW, _FAST))
    calm = float(np.median(noise[speed <= slow]))
    loud, at = float(np.median(noise[speed >= fast])), float(np.median(speed[speed >= fast]))
    if not calm > 0.0 or loud < _TIMES * calm or at == 0.0:
        return None
    return float(np.sqrt(loud**2 - calm**2) / at)


CHECK = QualityCheck("unsteady-sampling", find)
