"""The page of the reproduction: each table and figure of the paper as rows with a verdict."""

from collections.abc import Sequence
from functools import partial

from tsas_cli.paper import Paper
from tsas_cli.reporting.content import Group as Fold
from tsas_cli.reporting.content import Picture, Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.curves import draw_curves
from tsas_cli.reporting.numbers import ABSENT, plain
from tsas_cli.reporting.rendered import rendered
from tsas_cli.reproduction.group import Figure, Group, Row
from tsas_cli.reproduction.summary import sentence, verdict_table

HEADER = ("what", "paper", "ours", "ours / paper", "verdict", "evidence", "in the paper")
NUMERIC = frozenset({1, 2, 3})


def reproduction_page(paper: Paper, groups: Sequence[Group]) -> str:
    """Return the whole page as HTML."""
    citation = paper.citation
    return rendered(
        name="The paper done again",
        about=citation["title"],
        summary=sentence(groups),
        sections=(_overview(paper, groups), *(_section(group) for group in groups)),
    )


def _overview(paper: Paper, groups: Sequence[Group]) -> Section:
    citation = paper.citation
    header, rows = verdict_table(groups)
    return Section(
        "overview",
        "What is compared",
        (
            f"{citation['authors']}: {citation['title']}. {citation['journal']}, "
            f"doi {citation['doi']}.",
            "Every number and statement that can be computed is a row: the paper's value, ours, and a "
            "verdict that follows from a stated tolerance. Where they differ, the reason stands with "
            "the numbers behind it. Nothing is fitted to the paper's results.",
        ),
        commands=("tsas reproduce --out reports/paper",),
        tables=(Table("Verdicts", header, tuple(rows), numeric=frozenset(range(1, len(header)))),),
    )


def _section(group: Group) -> Section:
    folds: dict[str, list[Picture]] = {}
    for figure in group.figures:
        folds.setdefault(figure.part, []).append(_picture(figure))
    table = Table(group.title, HEADER, tuple(_cells(row) for row in group.rows), numeric=NUMERIC)
    return Section(
        group.anchor,
        group.title,
        group.intro,
        tables=(table.without_empty(),),
        pictures=tuple(folds.pop("", ())),
        groups=tuple(Fold(part, tuple(pictures)) for part, pictures in folds.items()),
        closing=group.closing,
    )


def _cells(row: Row) -> tuple[str, ...]:
    return (
        row.what,
        _with_unit(row.paper, row.unit),
        _with_unit(row.ours, row.unit),
        plain(row.ratio),
        row.words,
        row.evidence,
        row.source,
    )


def _with_unit(value: float | None, unit: str) -> str:
    return ABSENT if value is None else f"{plain(value)} {unit}"


def _picture(figure: Figure) -> Picture:
    labels = ", ".join(line.label for line in figure.lines)
    return picture(
        partial(draw_curves, figure=figure),
        key=figure.key,
        alt=f"{figure.caption} {figure.axes[1]} over {figure.axes[0]}: {labels}.",
        caption=figure.caption,
    )
