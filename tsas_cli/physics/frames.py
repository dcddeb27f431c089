"""Profiles along the tendon at chosen samples of a run: tensions and slip states.

The slip chain writes its own state into a `Frames`; nothing is computed again. Positions (`places`)
are shares of the total bend from 0 at the drive to 1 at the load, which are shares of the sheath's
length where it is evenly bent; between two neighbours is an element.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.phases import UNCONVERGED, Phases
from tsas_cli.support.arrays import Floats, Indices


class Frames(NamedTuple):
    """Profiles along m elements at k samples of a run.

    `slip` is +1 or −1 where an element's friction is at its limit in contraction or loosening (it
    slips, or rests as it slipped last), 0 where it sticks, 2 where it is slack, 3 where the chain
    did not converge.
    """

    samples: Indices  # increasing, shape (k,)
    tension_N: Floats  # at the nodes, shape (k, m + 1)
    slip: Phases  # of the elements, shape (k, m)
    front: Floats  # share of the sheath that slips, from the drive on, shape (k,)

    @property
    def places(self) -> Floats:
        """The positions of the tensions, shape (m + 1,) [1]."""
        return np.linspace(0.0, 1.0, self.tension_N.shape[1])


def empty_frames(samples: Indices, elements: int) -> Frames:
    """Return unfilled frames at samples, shape (k,), for the slip chain to write."""
    k = samples.size
    return Frames(
        samples.astype(np.int64),
        np.full((k, elements + 1), np.nan),
        np.full((k, elements), UNCONVERGED, dtype=np.int8),
        np.zeros(k),
    )


@kernel
def is_next(frames: Frames, taken: int, sample: int) -> bool:
    """Return whether a sample is the next one of the frames."""
    return taken < frames.samples.size and frames.samples[taken] == sample


@kernel
def slips_up_to(frames: Frames, k: int) -> float:
    """Return the share of elements, from the drive on, that slip in the same direction."""
    m = frames.slip.shape[1]
    first = frames.slip[k, 0]
    if first not in (1, -1):
        return 0.0
    count = 1
    while count < m and frames.slip[k, count] == first:
        count += 1
    return float(count / m)
