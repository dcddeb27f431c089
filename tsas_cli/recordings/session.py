"""The session that runs were recorded in, and how far into it a run begins."""

from datetime import datetime
from typing import NamedTuple


class Session(NamedTuple):
    """Starts of the first and the last run of a dataset."""

    first: datetime
    last: datetime

    def goes_on_at(self, started: datetime) -> bool:
        """Return whether a run is of it: one that starts later by no more than it has lasted."""
        if len({at.tzinfo is None for at in (started, *self)}) > 1 or started < self.first:
            return False
        return started - self.last <= self.last - self.first


def seconds_into(session_start: datetime | None, started: datetime | None) -> float:
    """Return the start of a run since that of its session, 0 where it is unknown [s]."""
    if session_start is None or started is None:
        return 0.0
    return (started - session_start).total_seconds()
