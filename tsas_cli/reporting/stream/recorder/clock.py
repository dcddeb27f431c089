"""When something was: on `t`, the time within its run, and on `session`, the time of day."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
import numpy.typing as npt
import rerun as rr

Floats = npt.NDArray[np.float64]

T, SESSION = "t", "session"


@dataclass(frozen=True)
class Times:
    """Moments of one run on the fixed timelines, to the nanosecond, shape (n,) each."""

    within: npt.NDArray[np.timedelta64]
    of_day: npt.NDArray[np.datetime64] | None = None

    def __len__(self) -> int:
        """How many moments there are."""
        return self.within.size

    @property
    def columns(self) -> list[rr.TimeColumn]:
        """The moments as Rerun takes them."""
        columns = [rr.TimeColumn(T, duration=self.within)]
        if self.of_day is not None:
            columns.append(rr.TimeColumn(SESSION, timestamp=self.of_day))
        return columns

    def at(self, indices: npt.NDArray[np.int64] | slice) -> "Times":
        """Return some of the moments."""
        of_day = None if self.of_day is None else self.of_day[indices]
        return Times(self.within[indices], of_day)

    def pieces(self, most: int) -> Iterator[tuple[slice, "Times"]]:
        """Yield stretches of at most so many moments, and where they are."""
        for first in range(0, len(self), most):
            at = slice(first, first + most)
            yield at, self.at(at)


@dataclass(frozen=True)
class Clock:
    """The clock of one run: when it began, None where that is not known.

    A start without a time zone is taken as it stands, so that the viewer shows what the manifest
    says.
    """

    started: datetime | None = None

    def times(self, time_s: Floats) -> Times:
        """Return moments by their time in the run [s], shape (n,), rounded to the nanosecond."""
        within = np.round(np.asarray(time_s, dtype=np.float64) * 1e9).astype("timedelta64[ns]")
        of_day = None if self.started is None else _nanoseconds(self.started) + within
        return Times(within, of_day)


def _nanoseconds(at: datetime) -> np.datetime64:
    if at.tzinfo is not None:
        at = at.astimezone(UTC).replace(tzinfo=None)
    return np.datetime64(at, "ns")
