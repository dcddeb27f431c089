"""When one hypothesis beats another: paired gains over blocks, never over samples."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

SURE = 2.6  # standard deviations of a sum with random signs; 1 in 200 by chance
AGREE = 0.8  # of the surest that so many blocks can be, where they are few
TELLING = 0.025  # of the squares, that a cause has to take away; conditioning leaves up to 0.01
APART = 0.01  # of the squares, that tells a cause from a rival
RICHER = 0.03  # of the squares, that a cause with more parameters has to gain on a simpler one
RESAMPLED = 2000


@dataclass(frozen=True)
class Gain:
    """What a hypothesis takes away from another one's held-out squares.

    `part` is of all squares; `sureness` is the sum of the blocks' relative gains in standard
    deviations of the same sum with random signs (a sign-flip test: a block that gains nothing
    does not speak). Few blocks cannot be surer than their root, so most of them have to agree:
    `needed` is how sure is sure.
    """

    part: float
    sureness: float
    needed: float = SURE

    def beyond(self, part: float) -> bool:
        """Say whether the gain is beyond chance, and larger than a part of the squares."""
        return self.sureness > self.needed and self.part > part

    @property
    def convincing(self) -> bool:
        """Whether the gain is beyond chance, and large enough to matter."""
        return self.beyond(TELLING)


def gain(before: Floats, after: Floats) -> Gain:
    """Compare the squares of two hypotheses over the same blocks, shape (blocks,)."""
    relative = np.log(before / after)
    spread = math.sqrt(float(relative @ relative))
    part = 1.0 - float(after.sum()) / float(before.sum())
    sureness = float(relative.sum()) / spread if spread > 0.0 else 0.0
    return Gain(part, sureness, min(SURE, AGREE * math.sqrt(before.size)))


def gain_percent(
    before: Floats, after: Floats, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Return by how much the root mean square falls [%], with its 95 % interval over blocks."""
    chosen = rng.integers(0, before.size, (RESAMPLED, before.size))
    falls = 100.0 * (1.0 - np.sqrt(after[chosen].sum(axis=1) / before[chosen].sum(axis=1)))
    low, high = np.quantile(falls, [0.025, 0.975])
    whole = 100.0 * (1.0 - math.sqrt(float(after.sum()) / float(before.sum())))
    return whole, float(low), float(high)
