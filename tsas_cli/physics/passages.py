"""Passages of the slip front: from the drive at each reversal, to the load or part of the way."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Phases = npt.NDArray[np.int8]


@dataclass(frozen=True)
class Passage:
    """One passage of a slip front, by samples.

    `direction` is +1 where the drive pulls, −1 where it releases. `arrived` is the first sample at
    which the whole tendon slips in that direction, None where the drive reverses before.
    """

    direction: int
    start: int
    arrived: int | None


def passages(x_in: Floats, phase: Phases) -> list[Passage]:
    """Return the passages of the front, one for each stroke of the drive.

    Parameters
    ----------
    x_in
        Displacement of the drive without noise, shape (n,) [mm].
    phase
        As `Response.phase`, shape (n,).
    """
    starts = turns(x_in)
    ends = [*starts[1:], x_in.size - 1][: starts.size]
    found = []
    for start, end in zip(starts, ends, strict=True):
        direction = 1 if x_in[end] > x_in[start] else -1
        arrivals = np.flatnonzero(phase[start + 1 : end + 1] == direction)
        arrived = int(start + 1 + arrivals[0]) if arrivals.size else None
        found.append(Passage(direction, int(start), arrived))
    return found


def ends_of(found: Sequence[Passage], last: int) -> list[int]:
    """Return the last sample of each passage: the start of the next one, or the last of all."""
    return [*(passage.start for passage in found[1:]), last][: len(found)]


def turns(x_in: Floats) -> Indices:
    """Return the samples at which the drive starts or reverses.

    A drive that rests in between reverses at the end of the rest.
    """
    moved = np.flatnonzero(np.diff(x_in))
    direction = x_in[moved + 1] > x_in[moved]
    return moved[np.flatnonzero(np.diff(direction, prepend=~direction[:1]))]
