"""A block of rows is written twice, one after the other, and the times run on.

A driver that hands out its buffer again when no new one is ready. Every channel then repeats, to
the last digit, as many rows as the block has. Noise never does; a computed recording without noise
repeats whole periods, but more than once.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import alternates
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

_FEWEST_ROWS = 4  # of a block


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the number of blocks that are written twice."""
    noisy = [values for values in trial.channels.values() if alternates(values)]
    if not noisy:
        yield CannotTell("no channel has noise, so rows may repeat by themselves")
        return
    table = np.column_stack([np.nan_to_num(values) for values in trial.channels.values()])
    row = np.unique(table, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(row, kind="stable")
    before = np.full(row.size, -1)
    same = row[order[1:]] == row[order[:-1]]
    before[order[1:][same]] = order[:-1][same]
    lag = np.where(before >= 0, np.arange(row.size) - before, 0)
    edges = np.flatnonzero(np.diff(lag, prepend=0, append=0))
    starts = [int(a) for a, b in pairwise(edges) if lag[a] == b - a >= _FEWEST_ROWS]
    if starts:
        first = starts[0]
        yield Remark(
            "error",
            f"{count_of(len(starts), 'block')} of rows repeat the block before in all channels; "
            f"the first has {lag[first]} rows and begins at {trial.time_s[first]:.6g} s, "
            f"row {trial.first_row + first}",
            "write each buffer once; remove the repeated rows with their times at the source",
            None,
            float(trial.time_s[first]),
        )


CHECK = QualityCheck("repeated-buffer", find)
