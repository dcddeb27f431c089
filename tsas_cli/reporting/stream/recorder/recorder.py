"""What is recorded: series, states, events, curves in two and three dimensions, and texts.

An entity is named by its parts, `("run", "a", "f_in_N")`; names from files need no escaping. Rerun
is strict here: columns of different lengths raise `ValueError`, else they would only be dropped.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import rerun as rr

from tsas_cli.reporting.stream.recorder.clock import Times
from tsas_cli.reporting.stream.recorder.paths import Entity, path_of
from tsas_cli.reporting.stream.recorder.views import Layout
from tsas_cli.support.errors import InputError

Floats = npt.NDArray[np.float64]
Colour = int  # 0xRRGGBBAA
Colours = npt.NDArray[np.uint32]

SLOWEST_S = 10.0  # that a viewer or a disk may take for what it was sent
ROWS = 8192  # of a series that are sent at a time
_EXTREMES = rr.components.AggregationPolicy.MinMax  # the usual average flattens what is fast


@dataclass(frozen=True)
class Recorder:
    """Writes entities to one stream; `opened.to_file` and `opened.to_viewer` open it."""

    stream: rr.RecordingStream
    where: object = ""

    def lay_out(self, layout: Layout) -> None:
        """Say what the viewer opens with; the last one counts."""
        self.stream.send_blueprint(layout)

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
        for at, piece in times.pieces(ROWS):
            there = ~np.isnan(values[at])
            columns = rr.Scalars.columns(scalars=values[at][there])
            if not there.all():
                columns = columns.partition(there.astype(np.int64))
            self.columns(entity, piece, columns)

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

    def marks(self, entity: Entity, name: str, colour: Colour, *, size: float = 4.0) -> None:
        """Say that the series of an entity is drawn as marks that are not joined."""
        style = rr.SeriesPoints(names=name, colors=colour, marker_sizes=size)
        self.static(entity, style)

    def states(
        self,
        entity: Entity,
        times: Times,
        states: Sequence[str],
        *,
        colours: Mapping[str, Colour],
        labels: Mapping[str, str] | None = None,
    ) -> None:
        """Add the states that begin at these times; an empty one ends the last.

        `colours` and `labels` are of all states that there may be.
        """
        names = list(colours)
        shown = [(labels or {}).get(name, name) for name in names]
        look = rr.StateConfiguration(values=names, labels=shown, colors=list(colours.values()))
        self.static(entity, look)
        self.columns(entity, times, rr.StateChange.columns(state=list(states)))

    def events(
        self, entity: Entity, times: Times, texts: Sequence[str], levels: Sequence[str]
    ) -> None:
        """Add lines of text, one at each time; a level is INFO, WARN or ERROR."""
        self.columns(entity, times, rr.TextLog.columns(text=list(texts), level=list(levels)))

    def markdown(self, entity: Entity, text: str) -> None:
        """Set a text that holds at all times, as Markdown."""
        self.static(entity, rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))

    def curves_2d(
        self,
        entity: Entity,
        curves: Sequence[Floats],
        colour: Colour,
        *,
        radius: float = -1.0,
        labels: Sequence[str] | None = None,
        order: float = 0.0,
    ) -> None:
        """Set curves in a plane, shape (n, 2) each, y downwards; they hold at all times.

        A negative radius is in points of the screen, here and below; higher `order` lies on top.
        """
        look = rr.LineStrips2D(
            list(curves), colors=colour, radii=radius, labels=labels, draw_order=order
        )
        self.static(entity, look)

    def labels_2d(
        self, entity: Entity, places: Floats, labels: Sequence[str], colour: Colour
    ) -> None:
        """Set texts in a plane at places of shape (n, 2), y downwards; they hold at all times."""
        look = rr.Points2D(places, labels=list(labels), colors=colour, radii=0.0, show_labels=True)
        self.static(entity, look)

    def segments_2d(
        self,
        entity: Entity,
        times: Times,
        segments: Floats,
        colour: Colour,
        *,
        radius: float = -1.5,
        order: float = 1.0,
    ) -> None:
        """Add a piece of a curve at each time, shape (n, 2, 2): ends, then x and y (downwards).

        A view with a range of time around the cursor shows the last stretch of the curve.
        """
        self.static(
            entity, rr.LineStrips2D.from_fields(colors=colour, radii=radius, draw_order=order)
        )
        self.columns(entity, times, rr.LineStrips2D.columns(strips=segments.astype(np.float32)))

    def points_2d(
        self,
        entity: Entity,
        times: Times,
        places: Floats,
        colour: Colour,
        *,
        radius: float = -5.0,
        order: float = 2.0,
    ) -> None:
        """Add one point at each time, shape (n, 2), y downwards."""
        self.static(entity, rr.Points2D.from_fields(colors=colour, radii=radius, draw_order=order))
        self.columns(entity, times, rr.Points2D.columns(positions=places.astype(np.float32)))

    def curves_3d(
        self,
        entity: Entity,
        curves: Sequence[Floats],
        colours: Colour | Sequence[Colour],
        *,
        radii: float | Sequence[float] = -1.5,
        labels: Sequence[str] | None = None,
    ) -> None:
        """Set curves in space, shape (n, 3) each; they hold at all times."""
        self.static(
            entity, rr.LineStrips3D(list(curves), colors=colours, radii=radii, labels=labels)
        )

    def points_3d(
        self,
        entity: Entity,
        times: Times,
        places: Sequence[Floats],
        colour: Colour,
        *,
        radii: float = -6.0,
    ) -> None:
        """Add any number of points at each time, shape (k, 3), k may be 0."""
        counts = np.array([len(at) for at in places])
        flat = np.concatenate([np.reshape(at, (-1, 3)) for at in places]).astype(np.float32)
        columns = rr.Points3D.columns(positions=flat).partition(counts)
        self.static(entity, rr.Points3D.from_fields(colors=colour, radii=radii))
        self.columns(entity, times, columns)

    def labels_3d(
        self, entity: Entity, places: Floats, labels: Sequence[str], colour: Colour
    ) -> None:
        """Set texts in space at places of shape (n, 3); they hold at all times."""
        look = rr.Points3D(places, labels=list(labels), colors=colour, radii=0.0, show_labels=True)
        self.static(entity, look)

    def static(self, entity: Entity, look: rr.AsComponents) -> None:
        """Set components that hold at all times; for the modules of this package."""
        self.stream.log(path_of(entity), look, static=True, strict=True)

    def columns(self, entity: Entity, times: Times, columns: rr.ComponentColumnList) -> None:
        """Add components that are others at each time; for the modules of this package."""
        self.stream.send_columns(path_of(entity), times.columns, columns, strict=True)
