"""What a viewer opens with: views as we set them up, in the containers of Rerun's blueprints.

A view shows the entities that it names, with everything below them.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import rerun.blueprint as rrb
from rerun.blueprint import Blueprint as Layout
from rerun.blueprint import Container, Grid, Horizontal, Tabs, Vertical, View, encodings

from tsas_cli.reporting.stream.recorder.clock import SESSION, T
from tsas_cli.reporting.stream.recorder.paths import Entity, path_of, with_all_below

__all__ = ["Container", "Grid", "Horizontal", "Layout", "Part", "Tabs", "Vertical", "View"]

Part = Container | View
Range = tuple[float, float]
Place = tuple[float, float, float]

_LINKED = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)  # all show the same stretch


def laid_out(root: Part, *, plays: bool = False) -> Layout:
    """Return the whole window: panels folded away, timeline `t`; `plays` where time runs."""
    return Layout(
        root,
        rrb.TimePanel(
            state="collapsed",
            timeline=T,
            loop_mode="All",
            play_state="Playing" if plays else "Paused",
        ),
        auto_layout=False,
        auto_views=False,
        collapse_panels=True,
    )


def outline(part: object) -> object:
    """Return what a part of a layout says, without the numbers that Rerun draws for each."""
    if isinstance(part, Part):
        return [(name, outline(value)) for name, value in vars(part).items() if name != "id"]
    return [outline(one) for one in part] if isinstance(part, list | tuple) else repr(part)


def series(
    name: str, entities: Sequence[Entity], *, y_range: Range | None = None, legend: bool = True
) -> View:
    """Return series over time; `y_range` where it is not told by what is shown."""
    return rrb.TimeSeriesView(
        **_shown(name, entities),
        axis_x=_LINKED,
        axis_y=None if y_range is None else rrb.ScalarAxis(range=y_range),
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=legend),
    )


def states(name: str, entities: Sequence[Entity]) -> View:
    """Return states over time, as coloured spans."""
    return rrb.StateTimelineView(**_shown(name, entities), time_view=_LINKED)


def plane(
    name: str,
    entities: Sequence[Entity],
    *,
    x_range: Range,
    y_range: Range,
    trails: Mapping[Entity, float] | None = None,
) -> View:
    """Return a plane, y downwards; of `trails` only the last seconds are shown."""
    return rrb.Spatial2DView(
        **_shown(name, entities),
        visual_bounds=rrb.VisualBounds2D(x_range=x_range, y_range=y_range),
        overrides={path_of(entity): _last(s) for entity, s in (trails or {}).items()},
    )


def space(name: str, entities: Sequence[Entity], *, eye: Place, target: Place, ground: int) -> View:
    """Return a space, z upwards, seen from `eye` towards `target`; `ground` is 0xRRGGBBAA."""
    return rrb.Spatial3DView(
        **_shown(name, entities),
        background=rrb.Background(color=ground, kind="SolidColor"),
        eye_controls=rrb.EyeControls3D(position=eye, look_target=target, eye_up=(0.0, 0.0, 1.0)),
        line_grid=False,
    )


def text(name: str, entity: Entity) -> View:
    """Return a text."""
    return rrb.TextDocumentView(**_shown(name, [entity]))


def log(name: str, entities: Sequence[Entity]) -> View:
    """Return events, line by line."""
    said = [encodings.TextLogColumn(kind) for kind in ("LogLevel", "Body")]
    return rrb.TextLogView(
        **_shown(name, entities), columns=rrb.TextLogColumns(text_log_columns=said)
    )


def _shown(name: str, entities: Sequence[Entity]) -> dict[str, Any]:
    expressions = [f"+ {with_all_below(entity)}" for entity in entities]
    return {"name": name, "origin": "/", "contents": expressions}


def _last(seconds: float) -> rrb.VisibleTimeRanges:
    boundary = rrb.TimeRangeBoundary
    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(
                timeline,
                start=boundary.cursor_relative(seconds=-seconds),
                end=boundary.cursor_relative(),
            )
            for timeline in (T, SESSION)
        ]
    )
