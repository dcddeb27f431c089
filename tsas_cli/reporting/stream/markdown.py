"""The report's sections and tables as Markdown; what comes from files stands as it is."""

import re
from collections.abc import Iterator, Sequence

from tsas_cli.reporting.content import Section, Table
from tsas_cli.support.errors import printable

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>()#+\-!|~&$^])")


def plain_text(text: str) -> str:
    """Return text of which no letter is read as Markdown or HTML, but for `code`."""
    text = printable(text)
    if text.count("`") % 2:
        return _escaped(text)
    return "".join(
        f"`{part}`" if place % 2 and part.strip() and "|" not in part else _escaped(part)
        for place, part in enumerate(text.split("`"))
    )


def section_text(section: Section) -> str:
    """Return a section with its parts, without its pictures."""
    return "\n\n".join(_blocks(section, 1))


def table_text(table: Table) -> str:
    """Return a table under its caption."""
    header = _row(table.header)
    rule = "|".join(
        "--:" if column in table.numeric else "---" for column in range(len(table.header))
    )
    rows = [line for k, row in enumerate(table.rows) for line in (_row(row), *_note(table, k))]
    return "\n".join([f"**{plain_text(table.caption)}**", "", header, f"|{rule}|", *rows])


def _escaped(text: str) -> str:
    return _SPECIAL.sub(r"\\\1", text)


def _blocks(section: Section, level: int) -> Iterator[str]:
    yield f"{'#' * level} {plain_text(section.title)}"
    yield from map(plain_text, section.intro)
    yield from (f"> {plain_text(equation)}" for equation in section.equations)
    if section.points:
        yield "\n".join(f"- {plain_text(point)}" for point in section.points)
    yield from map(table_text, section.tables)
    yield from map(plain_text, section.closing)
    for part in section.parts:
        yield from _blocks(part, level + 1)


def _row(cells: Sequence[str]) -> str:
    return "|" + "|".join(f" {plain_text(cell)} " for cell in cells) + "|"


def _note(table: Table, row: int) -> Iterator[str]:
    if table.notes and table.notes[row]:
        yield _row((table.notes[row], *[""] * (len(table.header) - 1)))
