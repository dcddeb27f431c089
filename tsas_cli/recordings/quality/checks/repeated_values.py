"""A channel repeats its value far more often than its noise would: a median filter before it.

A median keeps one sample of its window until another one is in the middle. Reported where a
channel whose noise is larger than its steps repeats neighbours where it moves least, at
irregular intervals; at regular ones it is updated less often (`slow-channel`).
"""

import math
from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.checks.slow_channel import is_held
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_BLOCK = 32  # rows
_CALM, _FEWEST_BLOCKS = 0.15, 4  # of all blocks
_MORE, _MOST = 2.0, 0.3  # times the share by chance, and share beyond that


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the channels that repeat too many values."""
    fresh = ~trial.repeats
    for name, values in trial.mechanical.items():
        size = trial.sizes[name]
        if not trial.is_noisy(name) or is_held(values[fresh]):
            continue
        chance = size.step / (2.0 * math.sqrt(math.pi) * size.noise)
        share = _repeats_where_it_rests(values[fresh], size.noise, chance)
        if share > _MOST:
            yield Remark(
                "warning",
                f"{name} repeats its value in {100.0 * share:.2g} % of the rows where it rests, "
                f"its noise would in {100.0 * chance:.2g} %: as behind a median filter",
                "record the channel without the filter",
                name,
            )


def _repeats_where_it_rests(values: Floats, noise: float, chance: float) -> float:
    """Return the usual share of repeats in the blocks of rows in which a channel changes least."""
    blocks = values[: values.size // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    if blocks.shape[0] < _FEWEST_BLOCKS:
        return 0.0
    spans = np.ptp(blocks, axis=1)
    calm = blocks[spans <= np.quantile(spans, _CALM)]
    if calm.shape[0] < _FEWEST_BLOCKS or float(np.median(np.ptp(calm, axis=1))) < noise:
        return 0.0
    return float(np.median(np.mean(np.diff(calm, axis=1) == 0.0, axis=1))) - _MORE * chance


CHECK = QualityCheck("repeated-values", find)
