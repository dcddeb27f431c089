"""What is recorded: components of entities that hold at all times, or that are others at each.

An entity is named by its parts, `("run", "a", "f_in_N")`; names from files need no escaping. Rerun
is strict here: columns of different lengths raise `ValueError`, else they would only be dropped.
A negative radius is in points of the screen; in a plane y points downwards, and what has a higher
`order` lies on top.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
import numpy.typing as npt
import rerun as rr
from rerun.blueprint import Blueprint

from tsas_cli.support.errors import InputError

Floats = npt.NDArray[np.float64]
Entity = Sequence[str]
Colour = int  # 0xRRGGBBAA
Colours = npt.NDArray[np.uint32]

T, SESSION = "t", "session"  # time within the run, and time of day
SLOWEST_S = 10.0  # that a viewer or a disk may take for what it was sent
ROWS = 8192  # of a series that are sent at a time
_EXTREMES = rr.components.AggregationPolicy.MinMax  # the usual average flattens what is fast


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

        Raises
        ------
        InputError
            The file or the viewer does not take it.
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

    def markdown(self, entity: Entity, text: str) -> None:
        """Set a text, as Markdown."""
        self.static(entity, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))

    def line(self, entity: Entity, name: str, colour: Colour, *, width: float = 1.5) -> None:
        """Say how the series of an entity is drawn, and what the legend calls it."""
        style = rr.SeriesLines(
            names=name, colors=colour, widths=width, aggregation_policy=_EXTREMES
        )
        self.static(entity, style)

    def scalars(self, entity: Entity, times: Times, values: Floats) -> None:
        """Add samples of a series, shape (n,); NaN is a gap, which stays one."""
        if values.shape != (len(times),):
            raise ValueError(f"{values.shape} values at {len(times)} times")
        for first in range(0, len(times), ROWS):
            at = slice(first, first + ROWS)
            there = ~np.isnan(values[at])
            columns = rr.Scalars.columns(scalars=values[at][there])
            if not there.all():
                columns = columns.partition(there.astype(np.int64))
            self.columns(entity, times.at(at), columns)

    def labels(self, entity: Entity, places: Floats, labels: Sequence[str], colour: Colour) -> None:
        """Set texts at places of shape (n, 2) in a plane, or (n, 3) in space."""
        points = rr.Points2D if places.shape[1] == 2 else rr.Points3D
        look = points(places, labels=list(labels), colors=colour, radii=0.0, show_labels=True)
        self.static(entity, look)

    def segments_2d(
        self,
        entity: Entity,
        times: Times,
        segments: Floats,
        colour: Colour,
        *,
        radius: float,
        order: float = 1.0,
    ) -> None:
        """Add a piece of a curve at each time, shape (n, 2, 2): ends, then x and y.

        A view with a range of time around the cursor shows the last stretch of the curve.
        """
        look = rr.LineStrips2D.from_fields(colors=colour, radii=radius, draw_order=order)
        self.static(entity, look)
        self.columns(entity, times, rr.LineStrips2D.columns(strips=segments.astype(np.float32)))

    def points_2d(
        self,
        entity: Entity,
        times: Times,
        places: Floats,
        colour: Colour,
        *,
        shown: npt.NDArray[np.bool_] | None = None,
        radius: float = -5.0,
        order: float = 3.0,
    ) -> None:
        """Add one point at each time, shape (n, 2), or none where it is not `shown`, shape (n,)."""
        look = rr.Points2D.from_fields(colors=colour, radii=radius, draw_order=order)
        self.static(entity, look)
        there = np.full(len(places), True) if shown is None else shown
        columns = rr.Points2D.columns(positions=places[there].astype(np.float32))
        self.columns(entity, times, columns.partition(there.astype(np.int64)))

    def points_3d(
        self,
        entity: Entity,
        times: Times,
        places: Sequence[Floats],
        colour: Colour,
        *,
        radius: float,
    ) -> None:
        """Add any number of points at each time, shape (k, 3), k may be 0."""
        self.static(entity, rr.Points3D.from_fields(colors=colour, radii=radius))
        columns = rr.Points3D.columns(positions=np.concatenate(places).astype(np.float32))
        self.columns(entity, times, columns.partition([len(at) for at in places]))

    def curves_3d(
        self,
        entity: Entity,
        times: Times,
        strips: Sequence[Sequence[Floats]],
        colour: Colour | Colours,
        *,
        radius: float,
    ) -> None:
        """Add any number of curves at each time, shape (p, 3) each.

        They have one colour, or one at each time, shape (n,).
        """
        self.static(entity, rr.LineStrips3D.from_fields(radii=radius))
        if isinstance(colour, int):
            self.static(entity, rr.LineStrips3D.from_fields(colors=colour))
        else:
            self.columns(entity, times, rr.LineStrips3D.columns(colors=colour))
        flat = [np.asarray(strip, dtype=np.float32) for at in strips for strip in at]
        columns = rr.LineStrips3D.columns(strips=flat)
        self.columns(entity, times, columns.partition([len(at) for at in strips]))
