"""The rows of a run that duplicate another run's, and have zero weight."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class CopiedRows:
    """Stretches of rows, each from its first row to the one after its last."""

    stretches: tuple[tuple[int, int], ...] = ()

    def mask(self, start: int, stop: int) -> npt.NDArray[np.bool_]:
        """Return which of the rows from `start` to `stop` − 1 are copies, shape (stop − start,)."""
        copied = np.zeros(stop - start, dtype=np.bool_)
        for first, end in self.stretches:
            copied[max(first - start, 0) : max(end - start, 0)] = True
        return copied


NONE_COPIED = CopiedRows()
