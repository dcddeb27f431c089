"""What a viewer opens with, in plain words: views, and how they are laid out.

A view shows the entities that it names, with everything below them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tsas_cli.reporting.stream.recorder.paths import Entity

Range = tuple[float, float]
Place = tuple[float, float, float]


@dataclass(frozen=True)
class Series:
    """Series over time; `y_range` where it is not told by what is shown."""

    name: str
    entities: Sequence[Entity]
    y_range: Range | None = None
    legend: bool = True


@dataclass(frozen=True)
class States:
    """States over time, as coloured spans."""

    name: str
    entities: Sequence[Entity]


@dataclass(frozen=True)
class Plane:
    """A plane, y downwards; of the entities in `trails` only the last seconds are shown."""

    name: str
    entities: Sequence[Entity]
    x_range: Range
    y_range: Range
    trails: Mapping[Entity, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Space:
    """A space, z upwards, seen from `eye` towards `target`.

    `ground` is the colour behind it all, 0xRRGGBBAA.
    """

    name: str
    entities: Sequence[Entity]
    eye: Place
    target: Place
    ground: int = 0x0D1014FF


@dataclass(frozen=True)
class Text:
    """A text."""

    name: str
    entity: Entity


@dataclass(frozen=True)
class Log:
    """Events, line by line."""

    name: str
    entities: Sequence[Entity]


@dataclass(frozen=True)
class Rows:
    """Parts under each other; `shares` are their heights."""

    parts: Sequence["Part"]
    shares: Sequence[float] | None = None
    name: str = ""


@dataclass(frozen=True)
class Columns:
    """Parts beside each other; `shares` are their widths."""

    parts: Sequence["Part"]
    shares: Sequence[float] | None = None
    name: str = ""


@dataclass(frozen=True)
class Grid:
    """Parts in a grid of so many columns."""

    parts: Sequence["Part"]
    columns: int
    name: str = ""


@dataclass(frozen=True)
class Tabs:
    """Parts behind each other, one of them on top."""

    parts: Sequence["Part"]
    name: str = ""
    on_top: int = 0


View = Series | States | Plane | Space | Text | Log
Part = View | Rows | Columns | Grid | Tabs


@dataclass(frozen=True)
class Layout:
    """The whole window; `plays` where time runs from the beginning."""

    root: Part
    plays: bool = False
