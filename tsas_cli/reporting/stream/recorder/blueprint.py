"""A layout as a blueprint of Rerun."""

from collections.abc import Mapping, Sequence
from functools import singledispatch
from typing import Any

import rerun.blueprint as rrb
from rerun.blueprint import encodings

from tsas_cli.reporting.stream.recorder.clock import SESSION, T
from tsas_cli.reporting.stream.recorder.layout import (
    Columns,
    Grid,
    Layout,
    Log,
    Part,
    Plane,
    Rows,
    Series,
    Space,
    States,
    Tabs,
    Text,
    View,
)
from tsas_cli.reporting.stream.recorder.paths import Entity, path_of, with_all_below

_LINKED = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)  # all show the same stretch


def blueprint_of(layout: Layout) -> rrb.Blueprint:
    """Return the blueprint: the layout, the panels beside it folded away, the timeline `t`."""
    return rrb.Blueprint(
        _part(layout.root),
        rrb.TimePanel(
            state="collapsed",
            timeline=T,
            loop_mode="All",
            play_state="Playing" if layout.plays else "Paused",
        ),
        auto_layout=False,
        auto_views=False,
        collapse_panels=True,
    )


@singledispatch
def _part(part: Part) -> rrb.Container | rrb.View:
    raise TypeError(f"{type(part).__name__} is no part of a layout")


@_part.register
def _(part: Rows) -> rrb.Container:
    return rrb.Vertical(
        *map(_part, part.parts), row_shares=_listed(part.shares), name=part.name or None
    )


@_part.register
def _(part: Columns) -> rrb.Container:
    return rrb.Horizontal(
        *map(_part, part.parts), column_shares=_listed(part.shares), name=part.name or None
    )


@_part.register
def _(part: Grid) -> rrb.Container:
    return rrb.Grid(*map(_part, part.parts), grid_columns=part.columns, name=part.name or None)


@_part.register
def _(part: Tabs) -> rrb.Container:
    return rrb.Tabs(*map(_part, part.parts), active_tab=part.on_top, name=part.name or None)


@_part.register
def _(part: Series) -> rrb.View:
    axis = None if part.y_range is None else rrb.ScalarAxis(range=part.y_range)
    return rrb.TimeSeriesView(
        **_shown(part, part.entities),
        axis_x=_LINKED,
        axis_y=axis,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=part.legend),
    )


@_part.register
def _(part: States) -> rrb.View:
    return rrb.StateTimelineView(**_shown(part, part.entities), time_view=_LINKED)


@_part.register
def _(part: Plane) -> rrb.View:
    bounds = rrb.VisualBounds2D(x_range=part.x_range, y_range=part.y_range)
    return rrb.Spatial2DView(
        **_shown(part, part.entities), visual_bounds=bounds, overrides=_trails(part.trails)
    )


@_part.register
def _(part: Space) -> rrb.View:
    eye = rrb.EyeControls3D(position=part.eye, look_target=part.target, eye_up=(0.0, 0.0, 1.0))
    return rrb.Spatial3DView(
        **_shown(part, part.entities),
        background=rrb.Background(color=part.ground, kind="SolidColor"),
        eye_controls=eye,
        line_grid=False,
    )


@_part.register
def _(part: Text) -> rrb.View:
    return rrb.TextDocumentView(**_shown(part, (part.entity,)))


@_part.register
def _(part: Log) -> rrb.View:
    said = [encodings.TextLogColumn(kind) for kind in ("LogLevel", "Body")]
    return rrb.TextLogView(
        **_shown(part, part.entities), columns=rrb.TextLogColumns(text_log_columns=said)
    )


def _shown(view: View, entities: Sequence[Entity]) -> dict[str, Any]:
    expressions = [f"+ {with_all_below(entity)}" for entity in entities]
    return {"name": view.name, "origin": "/", "contents": expressions}


def _trails(trails: Mapping[Entity, float]) -> dict[Any, rrb.VisibleTimeRanges]:
    return {path_of(entity): _last(seconds) for entity, seconds in trails.items()}


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


def _listed(shares: Sequence[float] | None) -> list[float] | None:
    return None if shares is None else list(shares)
