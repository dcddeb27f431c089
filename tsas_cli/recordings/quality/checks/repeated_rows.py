"""Rows repeat the row before them in every channel.

The logger asked faster than the sensors answered, or held the last value while the link was down.
Noise makes an exact repeat unlikely; how unlikely follows from each channel's noise and step of
quantisation, and only repeats far beyond that are told.
"""

import math
from collections.abc import Iterator

import numpy as np

from tsas_cli.numerics.noise import noise_sd
from tsas_cli.recordings.dataset import Floats
from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial, alternates

_CHANCE_TOO_HIGH = 0.2


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Count exact repeats and hold them against chance."""
    rows = np.column_stack(list(trial.channels.values()))
    repeats = np.concatenate(([False], (rows[1:] == rows[:-1]).all(axis=1)))
    count, n = int(repeats.sum()), repeats.size
    if count == 0:
        return
    chance = math.prod(
        _chance(values[~repeats], trial.step[name]) for name, values in trial.channels.items()
    )
    if chance > _CHANCE_TOO_HIGH:
        yield CannotTell("the channels are so quiet or so coarse that rows repeat by themselves")
    elif count > 3.0 * n * chance + 10.0:
        first = int(np.argmax(repeats))
        yield Remark(
            "warning",
            f"{count} of {n} rows ({100 * count / n:.2g} %) repeat the row before them in all "
            f"channels; noise alone would do so in at most {100 * chance:.2g} %",
            "record no faster than the slowest sensor answers, or drop the repeats at ingest",
            first_s=float(trial.time_s[first]),
        )


def _chance(values: Floats, step: float) -> float:
    """Return how likely a sample at rest equals the one before it; 1 where there is no noise."""
    noise = noise_sd(values)
    if not alternates(values) or not noise > 0.0:
        return 1.0
    return min(1.0, step / (2.0 * math.sqrt(math.pi) * noise))


CHECK = Check("repeated-rows", find)
