"""How the slip front ran: from the drive at each reversal, to the load or not."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Phases = npt.NDArray[np.int8]


@dataclass(frozen=True)
class Passage:
    """One run of a slip front, by samples.

    `direction` is +1 where the drive pulls, −1 where it lets go. `arrived` is the first sample at
    which the whole tendon slips that way, None where the drive turned before.
    """

    direction: int
    start: int
    arrived: int | None


def passages(x_in: Floats, phase: Phases) -> list[Passage]:
    """Return the runs of the front, one for each stroke of the drive.

    Parameters
    ----------
    x_in
        Displacement of the drive without noise, shape (n,) [mm].
    phase
        As `Response.phase` has it, shape (n,).
    """
    starts = turns(x_in)
    ends = [*starts[1:], x_in.size - 1][: starts.size]
    found = []
    for start, end in zip(starts, ends, strict=True):
        direction = 1 if x_in[end] > x_in[start] else -1
        there = np.flatnonzero(phase[start + 1 : end + 1] == direction)
        arrived = int(start + 1 + there[0]) if there.size else None
        found.append(Passage(direction, int(start), arrived))
    return found


def ends_of(found: Sequence[Passage], last: int) -> list[int]:
    """Return the sample with which each run ends: the start of the next one, or the last of all."""
    return [*(passage.start for passage in found[1:]), last][: len(found)]


def turns(x_in: Floats) -> Indices:
    """Return the samples from which the drive moves another way, where it starts too.

    A drive that rests in between turns at the end of the rest.
    """
    moved = np.flatnonzero(np.diff(x_in))
    way = x_in[moved + 1] > x_in[moved]
    return moved[np.flatnonzero(np.diff(way, prepend=~way[:1]))]
