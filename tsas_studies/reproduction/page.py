"""The page of the reproduction: each table and figure of the paper as rows with a verdict."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.paper import Paper
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Fact, Glance, Picture, Section, rendered, table_of
from tsas_cli.reporting.content import Group as Fold
from tsas_cli.reporting.drawing import kept_samples, legend, picture
from tsas_cli.reporting.numbers import ABSENT, as_printed, plain, spanned
from tsas_studies.reproduction.group import Figure, Group, Line, Row
from tsas_studies.reproduction.summary import counted, sentence, verdict_table

HEADER = ("what", "paper", "ours", "ours / paper", "verdict")
WITHOUT_UNIT = {"1", "not printed", ""}
_HOW = (
    "Every number and statement that can be computed is a row: the paper's value, ours, and a "
    "verdict that follows from a stated tolerance. Under it stand the reason, the numbers behind "
    "it, and in brackets where the paper says it. Where the paper is held against itself, ours is "
    "what follows from its other numbers. No value of ours is fitted to its results."
)


def reproduction_page(paper: Paper, groups: Sequence[Group]) -> str:
    """Return the whole page as HTML."""
    return rendered(
        name="The paper done again",
        about=paper.citation["title"],
        summary=sentence(groups),
        glance=_glance(groups),
        sections=(_overview(paper, groups), *(_section(group) for group in groups)),
    )


def _glance(groups: Sequence[Group]) -> Glance:
    counts = counted(groups)
    facts = tuple(Fact(verdict, str(count)) for verdict, count in counts.items())
    total = sum(counts.values())
    verdict = f"{counts['agrees']} of {total} numbers and statements agree"
    return Glance("What the paper prints, computed again", verdict, "", facts)


def _overview(paper: Paper, groups: Sequence[Group]) -> Section:
    cited = "{authors}: {title}. {journal}, doi {doi}.".format(**paper.citation)
    header, rows = verdict_table(groups)
    return Section(
        "overview",
        "What is compared",
        (cited, _HOW),
        commands=("tsas reproduce --out reports/paper",),
        tables=(table_of("Verdicts", header, rows),),
    )


def _section(group: Group) -> Section:
    folds: dict[str, list[Picture]] = {}
    for figure in group.figures:
        folds.setdefault(figure.part, []).append(_picture(figure))
    rows = group.rows
    caption = "The paper's values and ours"
    table = table_of(caption, HEADER, map(_cells, rows), notes=map(_note, rows))
    return Section(
        group.anchor,
        group.title,
        group.intro,
        tables=(table,),
        pictures=tuple(folds.pop("", ())),
        groups=tuple(Fold(part, tuple(pictures)) for part, pictures in folds.items()),
        closing=group.closing,
    )


def _cells(row: Row) -> tuple[str, ...]:
    return (
        row.what,
        _with_unit(as_printed(row.paper), row.unit),
        _with_unit(plain(row.ours), row.unit),
        plain(row.ratio),
        row.verdict,
    )


def _note(row: Row) -> str:
    """Return the verdict in words, what it rests on, and where the paper says it."""
    words = f"{row.words[0].upper()}{row.words[1:]}."
    return " ".join(part for part in (words, row.evidence, f"[{row.source}]") if part)


def _with_unit(number: str, unit: str) -> str:
    shown = unit.replace("^2", "²").replace("^3", "³")
    return number if number == ABSENT or unit in WITHOUT_UNIT else f"{number} {shown}"


def _in_words(line: Line) -> str:
    """Return where a curve goes, or where a single point lies."""
    if line.x.size == 1:
        return f"{line.label}: {plain(float(line.y[0]))} at {plain(float(line.x[0]))}"
    most = int(np.nanargmax(line.y))
    return (
        f"{line.label}: {spanned(line.y)} over {spanned(line.x)}, highest at "
        f"{plain(float(line.x[most]), 3)}"
    )


def _picture(figure: Figure) -> Picture:
    said = "; ".join(map(_in_words, figure.lines))
    return picture(
        partial(_draw, lines=figure.lines, axes=figure.axes),
        key=figure.key,
        alt=f"{figure.caption} {figure.axes[1]} over {figure.axes[0]}. {said}.",
        caption=figure.caption,
    )


def _draw(drawing: Any, lines: Sequence[Line], axes: tuple[str, str]) -> None:
    """Draw the later lines over the earlier ones."""
    plot = drawing.add_subplot(xlabel=axes[0], ylabel=axes[1])
    for line in lines:
        kept = kept_samples(line.x, line.y)
        style = "none" if line.mark else (0, (5, 3)) if line.dashed else "-"
        look = {"color": STAND_IN[line.role], "linestyle": style, "marker": line.mark or None}
        plot.plot(line.x[kept], line.y[kept], label=line.label, **look)
    legend(drawing, handlelength=1.8)
