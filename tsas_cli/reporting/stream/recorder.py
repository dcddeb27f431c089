"""What is recorded: components of entities that hold at all times, or that are others at each.

An entity is named by its parts, `("run", "a", "f_in_N")`; names from files need no escaping. Rerun
is strict here: columns of different lengths raise `ValueError`, else they would only be dropped.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
import numpy.typing as npt
import rerun as rr
from rerun.blueprint import Blueprint

from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError

Entity = Sequence[str]

T, SESSION = "t", "session"  # time within the run, and time of day
SLOWEST_S = 10.0  # that a viewer or a disk may take for what it was sent
ROWS = 8192  # of a series that are sent at a time
_EXTREMES = rr.components.AggregationPolicy.MinMax  # the usual average flattens what is fast


@dataclass(frozen=True)
class Times:
    """Moments of one run on the fixed timelines, to the nanosecond, shape (n,) each."""

    within: npt.NDArray[np.timedelta64]
    of_day: npt.NDArray[np.datetime64] | None = None

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


def path_of(entity: Entity) -> str:
    """Return the path of an entity; what a part holds that is no plain letter is escaped."""
    return rr.new_entity_path(list(entity))


@dataclass(frozen=True)
class Recorder:
    """Writes entities to one stream; `to_file` and `to_viewer` of `opened` open it."""

    stream: rr.RecordingStream
    where: object = ""

    def lay_out(self, layout: Blueprint) -> None:
        """Say what the viewer opens with; the last one counts."""
        self.stream.send_blueprint(layout)

    def settle(self) -> None:
        """Wait until what was recorded is written: what waits for it is kept in memory.

        InputError: the file or the viewer does not take it.
        """
        try:
            self.stream.flush(timeout_sec=SLOWEST_S)
        except RuntimeError as error:
            raise InputError(
                f"does not take the stream ({error})",
                where=self.where,
                remedy="is the disk full, or the viewer gone?",
            ) from error

    def static(self, entity: Entity, look: rr.AsComponents) -> None:
        """Set components that hold at all times."""
        self.stream.log(path_of(entity), look, static=True, strict=True)

    def columns(self, entity: Entity, times: Times, columns: rr.ComponentColumnList) -> None:
        """Add components that are others at each time."""
        self.stream.send_columns(path_of(entity), times.columns, columns, strict=True)

    def series(
        self,
        entity: Entity,
        times: Times,
        values: Floats,
        name: str,
        colour: int,
        *,
        width: float = 1.5,
    ) -> None:
        """Add all samples of a series, shape (n,), NaN for gaps, which stay gaps.

        The legend calls it `name`; `colour` is 0xRRGGBBAA.
        """
        if values.shape != times.within.shape:
            raise ValueError(f"{values.shape} values at {times.within.size} times")
        look = rr.SeriesLines(names=name, colors=colour, widths=width, aggregation_policy=_EXTREMES)
        self.static(entity, look)
        for first in range(0, values.size, ROWS):
            at = slice(first, first + ROWS)
            there = ~np.isnan(values[at])
            columns = rr.Scalars.columns(scalars=values[at][there])
            if not there.all():
                columns = columns.partition(there.astype(np.int64))
            self.columns(entity, times.at(at), columns)
