"""When something was: on `t`, the time within its run, and on `session`, the time of day."""

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


def times_of(time_s: Floats, started: datetime | None = None) -> Times:
    """Return moments by their time in the run [s], shape (n,), rounded to the nanosecond.

    A start without a time zone is taken as it stands, so that the viewer shows what the manifest
    says; None where it is not known.
    """
    within = np.round(np.asarray(time_s, dtype=np.float64) * 1e9).astype("timedelta64[ns]")
    if started is None:
        return Times(within)
    if started.tzinfo is not None:
        started = started.astimezone(UTC).replace(tzinfo=None)
    return Times(within, np.datetime64(started, "ns") + within)
