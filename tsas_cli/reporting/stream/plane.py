"""A frame in the plane of the viewer, where scales are equal and y points downwards.

Both axes are scaled to a frame of fixed size, and ticks at round numbers say what they were.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint import View

from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.numbers import as_printed, round_ticks
from tsas_cli.reporting.stream.recorder import SESSION, Entity, Recorder, T, path_of
from tsas_cli.reporting.stream.sources import Which
from tsas_cli.reporting.stream.views import all_below

Floats = npt.NDArray[np.float64]
Value = TypeVar("Value", float, Floats)

WIDTH, HEIGHT = 1.7, 1.0  # of the frame
MARGIN = 0.04  # of the range, beside the curve
TICKS = 5  # about as many to an axis
STEPS = (1.0, 2.0, 5.0, 10.0)
_SEEN = rrb.VisualBounds2D(x_range=(-0.2, WIDTH + 0.08), y_range=(-HEIGHT - 0.08, 0.28))
_TICK = 0.015
_KEY_LINE = 0.09  # of the frame's height


@dataclass(frozen=True)
class Axis:
    """One axis: its range, shown from 0 to `length`."""

    low: float
    high: float
    length: float

    def place(self, values: Value) -> Value:
        """Return where values stand."""
        return (values - self.low) / (self.high - self.low) * self.length

    def ticks(self) -> list[float]:
        """Return round numbers within the range."""
        least = 0.999 * (self.high - self.low) / TICKS
        return round_ticks(self.low, self.high, least, STEPS)


@dataclass(frozen=True)
class Frame:
    """Two axes, x to the right and y upwards as one reads it."""

    x: Axis
    y: Axis

    def place(self, x: Floats, y: Floats) -> Floats:
        """Return where points stand, shape (n, 2), y downwards."""
        return np.column_stack((self.x.place(x), -self.y.place(y)))

    def lines(self) -> list[Floats]:
        """Return the axes and their ticks as curves."""
        box = np.array([[0.0, -HEIGHT], [0.0, 0.0], [WIDTH, 0.0]])
        at_x, at_y = map(self.x.place, self.x.ticks()), map(self.y.place, self.y.ticks())
        return [
            box,
            *(np.array([[x, 0.0], [x, _TICK]]) for x in at_x),
            *(np.array([[0.0, -y], [-_TICK, -y]]) for y in at_y),
        ]

    def texts(self, x_label: str, y_label: str) -> tuple[Floats, list[str]]:
        """Return where ticks and axes are named, shape (k, 2), and how."""
        across = [(self.x.place(v), 0.02, as_printed(v)) for v in self.x.ticks()]
        up = [(-0.1, -self.y.place(v) - 0.04, as_printed(v)) for v in self.y.ticks()]
        named = [(WIDTH / 2.0, 0.14, x_label), (0.4 * WIDTH, -HEIGHT - 0.06, y_label)]
        texts = [*across, *up, *named]
        return np.array([(x, y) for x, y, _ in texts]), [text for *_, text in texts]


def plane_view(
    name: str, entity: Entity, trails: Mapping[tuple[str, ...], float] | None = None
) -> View:
    """Return the view of a plane; of each of `trails` only its last seconds are shown."""
    return rrb.Spatial2DView(
        name=name,
        contents=all_below([entity]),
        visual_bounds=_SEEN,
        overrides={path_of(trail): _last(seconds) for trail, seconds in (trails or {}).items()},
    )


def _last(seconds: float) -> rrb.VisibleTimeRanges:
    cursor = rrb.TimeRangeBoundary.cursor_relative
    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(timeline, start=cursor(seconds=-seconds), end=cursor())
            for timeline in (T, SESSION)
        ]
    )


def record_frame(
    recorder: Recorder, entity: Entity, frame: Frame, names: tuple[str, str], role: str
) -> None:
    """Draw a frame's axes below what is in it; `names` are those of x and y, in a role's colour."""
    axes = rr.LineStrips2D(frame.lines(), colors=dark("muted"), radii=-0.6, draw_order=-1.0)
    recorder.static((*entity, "axes"), axes)
    places, texts = frame.texts(*names)
    recorder.labels((*entity, "names"), places, texts, dark(role))


def record_key(
    recorder: Recorder, entity: Entity, models: Iterable[Which], *, measured: bool = False
) -> None:
    """Write the names of the models, and of what was measured, each in its colour."""
    named = [*models, Which("measured", "measured", "measured")] if measured else models
    for line, which in enumerate(named):
        place = np.array([[0.86 * WIDTH, -HEIGHT + _KEY_LINE * line]])
        recorder.labels((*entity, "key", which.key), place, [which.label], dark(which.role))


def frame_of(x: Floats, y: Floats) -> Frame:
    """Return the frame of a curve, NaN for gaps.

    Raises
    ------
    ValueError
        It has no point.
    """
    return Frame(_axis(x, WIDTH), _axis(y, HEIGHT))


def _axis(values: Floats, length: float) -> Axis:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = MARGIN * ((high - low) or abs(high) or 1.0)
    return Axis(low - room, high + room, length)
