"""Comparison of two hypotheses: paired reductions over blocks, not over samples."""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.support.arrays import Floats

CRITICAL_VALUE = 2.6  # critical value of the test statistic; 1 in 200 by chance
AGREE = 0.8  # of its largest possible value, the critical value for few blocks
LEAST_REDUCTION = 0.025  # least reduction of the squares by a cause; conditioning leaves up to 0.01
LEAST_DIFFERENCE = 0.01  # least reduction of the squares that distinguishes a cause from a rival
LEAST_REDUCTION_PER_COMPLEXITY = (
    0.03  # least reduction of the squares by a cause with more parameters than another
)
RESAMPLED = 2000  # bootstrap samples


@dataclass(frozen=True)
class Reduction:
    """Reduction of the held-out squares by a hypothesis compared with another one.

    `part` is the share of all squares; `test_statistic` is the sum of the blocks'
    relative reductions over the standard deviation of the same sum with random signs (a sign-flip
    test: a block without a change has no weight). It is at most the square root of the number of
    blocks, so that most of few blocks have to agree: `needed` is the critical value.
    """

    part: float
    test_statistic: float
    needed: float = CRITICAL_VALUE

    def beyond(self, part: float) -> bool:
        """Return whether the reduction is significant, and larger than a share of the squares."""
        return self.test_statistic > self.needed and self.part > part

    @property
    def convincing(self) -> bool:
        """Whether the reduction is significant and large enough."""
        return self.beyond(LEAST_REDUCTION)


def gain(before: Floats, after: Floats) -> Reduction:
    """Return the reduction between the squares of two hypotheses by block, shape (blocks,)."""
    relative = np.log(before / after)
    spread = math.sqrt(float(relative @ relative))
    part = 1.0 - float(after.sum()) / float(before.sum())
    test_statistic = float(relative.sum()) / spread if spread > 0.0 else 0.0
    return Reduction(part, test_statistic, min(CRITICAL_VALUE, AGREE * math.sqrt(before.size)))


def gain_percent(
    before: Floats, after: Floats, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Return the reduction of the RMS [%], with its 95 % interval over blocks."""
    chosen = rng.integers(0, before.size, (RESAMPLED, before.size))
    falls = 100.0 * (1.0 - np.sqrt(after[chosen].sum(axis=1) / before[chosen].sum(axis=1)))
    low, high = np.quantile(falls, [0.025, 0.975])
    whole = 100.0 * (1.0 - math.sqrt(float(after.sum()) / float(before.sum())))
    return whole, float(low), float(high)
