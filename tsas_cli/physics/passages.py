"""How the slip front ran: from the drive at each reversal, to the load or not."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
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
    moved = np.flatnonzero(np.diff(x_in))
    if moved.size == 0:
        return []
    way = np.sign(x_in[moved + 1] - x_in[moved]).astype(int)
    first = np.concatenate(([0], np.flatnonzero(np.diff(way)) + 1))
    starts, ways = moved[first], way[first]
    ends = np.append(starts[1:], x_in.size - 1)
    found = []
    for start, end, direction in zip(starts, ends, ways, strict=True):
        there = np.flatnonzero(phase[start + 1 : end + 1] == direction)
        arrived = int(start + 1 + there[0]) if there.size else None
        found.append(Passage(int(direction), int(start), arrived))
    return found
