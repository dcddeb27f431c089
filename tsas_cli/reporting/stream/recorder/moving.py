"""What moves: surfaces, curves, points and texts that are others at each time."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import rerun as rr

from tsas_cli.reporting.stream.recorder.clock import Times
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.recorder.recorder import Colour, Colours, Floats, Recorder


def surface(
    recorder: Recorder,
    entity: Entity,
    times: Times,
    corners: Floats,
    triangles: npt.NDArray[np.uint32],
    colours: Colours,
) -> None:
    """Add a surface at each time: corners, shape (n, v, 3), their colours, shape (n, v).

    The triangles, shape (m, 3), stay the same.
    """
    moments, count = colours.shape
    recorder.static(entity, rr.Mesh3D.from_fields(triangle_indices=triangles))
    columns = rr.Mesh3D.columns(
        vertex_positions=corners.reshape(-1, 3).astype(np.float32), vertex_colors=colours.ravel()
    )
    recorder.columns(entity, times, columns.partition(np.full(moments, count)))


def curves(
    recorder: Recorder,
    entity: Entity,
    times: Times,
    strips: Sequence[Sequence[Floats]],
    colour: Colour | Colours,
    *,
    radius: float = -1.5,
) -> None:
    """Add any number of curves at each time, shape (p, 3) each.

    They have one colour, or one at each time, shape (n,).
    """
    recorder.static(entity, rr.LineStrips3D.from_fields(radii=radius))
    if isinstance(colour, int):
        recorder.static(entity, rr.LineStrips3D.from_fields(colors=colour))
    else:
        recorder.columns(entity, times, rr.LineStrips3D.columns(colors=colour))
    flat = [np.asarray(strip, dtype=np.float32) for at in strips for strip in at]
    columns = rr.LineStrips3D.columns(strips=flat)
    recorder.columns(entity, times, columns.partition(np.array([len(at) for at in strips])))


def coloured_pieces(
    recorder: Recorder,
    entity: Entity,
    times: Times,
    pieces: Floats,
    colours: Colours,
    radii: Floats,
) -> None:
    """Set a curve of m pieces, shape (m, 2, 3), with colours and radii over time, shape (n, m)."""
    recorder.static(entity, rr.LineStrips3D(pieces.astype(np.float32)))
    moments, count = colours.shape
    columns = rr.LineStrips3D.columns(colors=colours.ravel(), radii=radii.ravel())
    recorder.columns(entity, times, columns.partition(np.full(moments, count)))


def points_2d(
    recorder: Recorder,
    entity: Entity,
    times: Times,
    places: Sequence[Floats],
    colour: Colour,
    *,
    radius: float = -5.0,
    order: float = 3.0,
) -> None:
    """Add any number of points at each time, shape (k, 2), y downwards, k may be 0."""
    look = rr.Points2D.from_fields(colors=colour, radii=radius, draw_order=order)
    recorder.static(entity, look)
    flat = np.concatenate([np.reshape(at, (-1, 2)) for at in places]).astype(np.float32)
    columns = rr.Points2D.columns(positions=flat)
    recorder.columns(entity, times, columns.partition(np.array([len(at) for at in places])))


def captions(
    recorder: Recorder,
    entity: Entity,
    times: Times,
    places: Floats,
    texts: Sequence[str],
    colour: Colour,
) -> None:
    """Add one text at each time, at places of shape (n, 3)."""
    recorder.static(entity, rr.Points3D.from_fields(colors=colour, radii=0.0, show_labels=True))
    columns = rr.Points3D.columns(positions=places.astype(np.float32), labels=list(texts))
    recorder.columns(entity, times, columns)
