"""Comparison of two hypotheses: paired reductions over blocks, not over samples."""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.support.arrays import Floats

CRITICAL_VALUE = 2.6  # critical value of the test statistic; 1 in 200 by chance
AGREE = 0.9  # of its largest possible value, the critical value for few blocks
LEAST_REDUCTION = 0.025  # least reduction of the squares by a cause; conditioning leaves up to 0.01
LEAST_REDUCTION_OF_NOISE = 0.1  # where the nominal model leaves noise alone, or
CRITICAL_VALUE_OF_ANY = 3.7  # that of the best of forty effects
LEAST_DIFFERENCE = 0.01  # least reduction of the squares that distinguishes a cause from a rival
LEAST_REDUCTION_PER_COMPLEXITY = (
    0.03  # least reduction of the squares by a cause with more parameters than another
)
REPEATS = 1.5  # periods of a wave in the longest stroke: any curve is a part of fewer
RESAMPLED = 2000  # bootstrap samples


@dataclass(frozen=True)
class Reduction:
    """Reduction of the held-out squares by a hypothesis compared with another one.

    `part` is the share of all squares; `test_statistic` that of Wilcoxon's signed-rank test of the
    blocks' relative reductions, in standard deviations by chance: a block without a change has no
    weight, and one with a large change not much more than others. It is largest where all blocks
    agree, so that most of few have to: `needed` is the critical value.
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

    @property
    def convincing_of_any(self) -> bool:
        """Whether it is so for the best of forty effects."""
        return self.convincing and self.test_statistic > CRITICAL_VALUE_OF_ANY

    @property
    def convincing_of_noise(self) -> bool:
        """Whether it is so where there may be no more than noise: larger, or more significant."""
        return self.convincing_of_any or self.beyond(LEAST_REDUCTION_OF_NOISE)


def gain(before: Floats, after: Floats) -> Reduction:
    """Return the reduction between the squares of two hypotheses by block, shape (blocks,)."""
    relative = np.log(before / after)
    ranks = np.argsort(np.argsort(np.abs(relative))) + 1.0
    by_chance = math.sqrt(float(np.sum(ranks[relative != 0.0] ** 2)))
    part = 1.0 - float(after.sum()) / float(before.sum())
    test_statistic = float(np.sign(relative) @ ranks) / by_chance if by_chance > 0.0 else 0.0
    most = float(ranks.sum()) / math.sqrt(float(ranks @ ranks))
    return Reduction(part, test_statistic, min(CRITICAL_VALUE, AGREE * most))


def gain_percent(
    before: Floats, after: Floats, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Return the reduction of the RMS [%], with its 95 % interval over blocks."""
    chosen = rng.integers(0, before.size, (RESAMPLED, before.size))
    falls = 100.0 * (1.0 - np.sqrt(after[chosen].sum(axis=1) / before[chosen].sum(axis=1)))
    low, high = np.quantile(falls, [0.025, 0.975])
    whole = 100.0 * (1.0 - math.sqrt(float(after.sum()) / float(before.sum())))
    return whole, float(low), float(high)
