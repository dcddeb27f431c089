"""Rows repeat the row before them in every channel.

The logger sampled faster than the sensors, or repeated the last value while the link was down.
Noise makes an exact repeat unlikely; its probability follows, block by block, from each channel's
noise and its smallest change. Reported are repeats far beyond that, in blocks where the noise of
some channel exceeds its smallest change: quiet channels repeat by chance.
"""

import math
from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import smallest_change
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats, Mask

_BLOCK = 32  # rows
_MEDIAN_OF_THIRD = 0.6745 * math.sqrt(20.0)  # of |third difference|, for noise of unit deviation


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the number of exact repeats if it is far above that expected by chance."""
    if not trial.channels:
        yield CannotTell("no column besides time holds enough numbers")
        return
    repeated = trial.repeats.copy()
    if not repeated.any():
        return
    block = (np.cumsum(~repeated) - 1) // _BLOCK  # a repeat belongs to the row that it repeats
    chance = _chances(trial, ~repeated)[block]
    noisy = chance < 1.0
    if not noisy.any():
        yield CannotTell("the channels are so quiet or so coarse that rows repeat by chance")
        return
    repeated &= noisy
    count, expected = int(repeated.sum()), float(chance[noisy].sum())
    if count > 3.0 * expected + 10.0:
        yield Remark(
            "warning",
            f"{count} of {repeated.size} rows ({100 * count / repeated.size:.2g} %) repeat the row "
            f"before them in all channels; with this noise about {expected:.0f} would",
            "record no faster than the slowest sensor updates, or drop the repeats at ingest",
            first_s=float(trial.time_s[np.argmax(repeated)]),
        )


def _chances(trial: RunSignals, fresh: Mask) -> Floats:
    """Return the probability that a row equals the preceding one, for each block of fresh rows.

    It is the largest of a block and its two neighbours, for blocks at the edge of a rest.
    """
    chance = np.ones(-(-int(fresh.sum()) // _BLOCK))
    for values in trial.channels.values():
        chance *= _chances_of(values[fresh], chance.size)
    padded = np.pad(chance, 1, mode="edge")
    return np.maximum(chance, np.maximum(padded[:-2], padded[2:]))


def _chances_of(values: Floats, blocks: int) -> Floats:
    """Return the probabilities of one channel; 1 where its noise is below its smallest change."""
    smallest = smallest_change(values)
    third = np.zeros(blocks * _BLOCK)
    third[: max(values.size - 3, 0)] = np.nan_to_num(np.abs(np.diff(values, 3)))
    noise = np.median(third.reshape(blocks, _BLOCK), axis=1) / _MEDIAN_OF_THIRD
    return np.where(noise > smallest, smallest / (2.0 * math.sqrt(math.pi) * noise + 1e-300), 1.0)


CHECK = QualityCheck("repeated-rows", find)
