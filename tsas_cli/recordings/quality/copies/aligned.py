"""Two runs read side by side, a piece at a time, each with the other's samples around it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.pieces import Piece
from tsas_cli.recordings.quality.copies.agreement import BESIDE, Samples

AT_ONCE = 1 << 16  # samples


@dataclass(frozen=True, eq=False)
class SideBySide:
    """Consecutive samples of a run, and a source's samples around them on the same clock.

    `row` is the number of the first sample in its run.
    """

    row: int
    samples: Samples
    source: Samples


def side_by_side(
    run: Iterator[Piece], source: Iterator[Piece], names: Sequence[str], shift_s: float
) -> Iterator[SideBySide]:
    """Yield all samples of a run, moved onto a source's clock, in order.

    Parameters
    ----------
    run, source
        The pieces of each, at least one.
    names
        The channels, which both have.
    shift_s
        How much later the run's samples are on the source's clock.
    """
    row, left = 0, Samples(np.empty(0), np.empty((0, len(names))))
    around = _samples(next(source), names)
    ahead = next(source, None)
    while True:
        if left.time_s.size == 0:
            part = next(run, None)
            if part is None:
                return
            row, left = part.start, _samples(part, names).moved(shift_s)
        # The last samples of a piece are not yet surrounded by others.
        until = np.inf if ahead is None else around.time_s[-BESIDE]
        here = min(int(np.searchsorted(left.time_s, until)), AT_ONCE)
        if here:
            now = left.part(slice(0, here))
            first, last = np.searchsorted(around.time_s, now.time_s[[0, -1]]).tolist()
            first = min(first, around.time_s.size - 2)  # a run may begin after the source's end
            near = around.part(slice(max(first - BESIDE, 0), last + BESIDE))
            yield SideBySide(row, now, near)
            row, left = row + here, left.part(slice(here, None))
        elif ahead is not None:
            kept = around.part(slice(-2 * BESIDE, None))
            more = _samples(ahead, names)
            around = Samples(
                np.concatenate((kept.time_s, more.time_s)),
                np.concatenate((kept.values, more.values)),
            )
            ahead = next(source, None)


def _samples(piece: Piece, names: Sequence[str]) -> Samples:
    return Samples(piece.columns[TIME], np.column_stack([piece.columns[n] for n in names]))
