"""Two runs read in parallel, in pieces: samples of one, and the surrounding ones of the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.pieces import Piece
from tsas_cli.recordings.quality.copies.agreement import MARGIN_ROWS, RunSamples

MOST_SAMPLES = 1 << 16  # compared at once


@dataclass(frozen=True, eq=False)
class SideBySide:
    """Consecutive samples of a run, and a source's samples around them on the same clock.

    `row` is the number of the first sample in its run.
    """

    row: int
    samples: RunSamples
    source: RunSamples


def side_by_side(
    run: Iterator[Piece], source: Iterator[Piece], names: Sequence[str], shift_s: float
) -> Iterator[SideBySide]:
    """Yield all samples of a run, moved onto a source's clock, in order.

    Parameters
    ----------
    run, source
        The pieces of each run, at least one.
    names
        The common channels.
    shift_s
        Shift of the run's times to the source's clock.
    """
    row, left = 0, RunSamples(np.empty(0), np.empty((0, len(names))))
    around = _samples(next(source), names)
    ahead = next(source, None)
    while True:
        if left.time_s.size == 0:
            part = next(run, None)
            if part is None:
                return
            row, left = part.start, _samples(part, names).moved(shift_s)
        # The last samples of a piece lack their margin until the next piece is read.
        until = np.inf if ahead is None else around.time_s[-MARGIN_ROWS]
        here = min(int(np.searchsorted(left.time_s, until)), MOST_SAMPLES)
        if here:
            now = left.part(slice(0, here))
            first, last = np.searchsorted(around.time_s, now.time_s[[0, -1]]).tolist()
            first = min(first, around.time_s.size - 2)  # the run may begin after the source's end
            near = around.part(slice(max(first - MARGIN_ROWS, 0), last + MARGIN_ROWS))
            yield SideBySide(row, now, near)
            row, left = row + here, left.part(slice(here, None))
        elif ahead is not None:
            overlap = around.part(slice(-2 * MARGIN_ROWS, None))
            more = _samples(ahead, names)
            around = RunSamples(
                np.concatenate((overlap.time_s, more.time_s)),
                np.concatenate((overlap.values, more.values)),
            )
            ahead = next(source, None)


def _samples(piece: Piece, names: Sequence[str]) -> RunSamples:
    return RunSamples(piece.columns[TIME], np.column_stack([piece.columns[n] for n in names]))
