"""What a model says along the tendon at chosen samples of a run: tensions, and where it slips.

The solvers write their own state into a `Frames`; nothing is computed again. Places are shares of
the total bend from 0 at the drive to 1 at the load, which are shares of the sheath's length where
it is evenly bent; between two neighbouring places is an element.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.phases import UNCONVERGED

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]
Indices = npt.NDArray[np.int64]


class Frames(NamedTuple):
    """Where a run is looked at, k samples, and what is found there at m elements.

    `slip` is +1 or −1 where an element's friction is at its limit in contraction or loosening (it
    slips, or stands as it slipped last), 0 where it sticks, 2 where it hangs slack, 3 where the
    solver did not converge.
    """

    samples: Indices  # rising, shape (k,)
    tension_N: Floats  # at the places, shape (k, m + 1)
    slip: Phases  # of the elements, shape (k, m)
    front: Floats  # share of the sheath up to which it slips from the drive on, shape (k,)

    @property
    def places(self) -> Floats:
        """The places that the tensions belong to, shape (m + 1,) [1]."""
        return np.linspace(0.0, 1.0, self.tension_N.shape[1])


def empty_frames(samples: Indices, elements: int) -> Frames:
    """Return frames at samples, shape (k,), for a solver to fill: nothing is known yet."""
    k = samples.size
    return Frames(
        samples.astype(np.int64),
        np.full((k, elements + 1), np.nan),
        np.full((k, elements), UNCONVERGED, dtype=np.int8),
        np.zeros(k),
    )


@kernel
def is_next(frames: Frames, taken: int, sample: int) -> bool:
    """Say whether a sample is the next one to be looked at."""
    return taken < frames.samples.size and frames.samples[taken] == sample


@kernel
def slips_up_to(frames: Frames, k: int) -> float:
    """Return the share of the elements that slip alike from the drive on."""
    m = frames.slip.shape[1]
    first = frames.slip[k, 0]
    if first not in (1, -1):
        return 0.0
    count = 1
    while count < m and frames.slip[k, count] == first:
        count += 1
    return float(count / m)
