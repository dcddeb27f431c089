"""What a viewer opens with: views as we set them up, in the containers of Rerun's blueprints.

A view shows the entities that it names, with everything below them.
"""

from collections.abc import Sequence

import rerun.blueprint as rrb
from rerun.blueprint import Blueprint, Container, View, encodings

from tsas_cli.reporting.stream.recorder import Entity, T, path_of

Part = Container | View

_LINKED = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)  # all show the same stretch


def laid_out(root: Part, *, plays: bool = False) -> Blueprint:
    """Return the whole window: panels folded away, timeline `t`; `plays` where time runs."""
    return Blueprint(
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


def series(name: str, entities: Sequence[Entity], *, legend: bool = True) -> View:
    """Return series over time."""
    return rrb.TimeSeriesView(
        name=name,
        contents=all_below(entities),
        axis_x=_LINKED,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=legend),
    )


def states(name: str, entities: Sequence[Entity]) -> View:
    """Return states over time, as coloured spans."""
    return rrb.StateTimelineView(name=name, contents=all_below(entities), time_view=_LINKED)


def text(name: str, entity: Entity) -> View:
    """Return a text."""
    return rrb.TextDocumentView(name=name, contents=all_below([entity]))


def log(name: str, entities: Sequence[Entity]) -> View:
    """Return events, line by line."""
    said = [encodings.TextLogColumn(kind) for kind in ("LogLevel", "Body")]
    return rrb.TextLogView(
        name=name, contents=all_below(entities), columns=rrb.TextLogColumns(text_log_columns=said)
    )


def all_below(entities: Sequence[Entity]) -> list[str]:
    """Return the expressions that find entities and everything below them."""
    return [f"+ {path_of(entity)}/**" for entity in entities]
