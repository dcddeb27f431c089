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
    """Moments of one run as columns of the fixed timelines, equal to the nanosecond."""

    columns: tuple[rr.TimeColumn, ...]

    def __len__(self) -> int:
        """How many moments there are."""
        return len(self.columns[0].as_arrow_array())


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
        columns = [rr.TimeColumn(T, duration=within)]
        if self.started is not None:
            columns.append(rr.TimeColumn(SESSION, timestamp=_nanoseconds(self.started) + within))
        return Times(tuple(columns))


def _nanoseconds(at: datetime) -> np.datetime64:
    if at.tzinfo is not None:
        at = at.astimezone(UTC).replace(tzinfo=None)
    return np.datetime64(at, "ns")
