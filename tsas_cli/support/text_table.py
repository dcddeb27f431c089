"""A table as lines of text: as wide as it is, or folded to fit a terminal."""

import math
from collections.abc import Iterator, Sequence
from textwrap import wrap

from tsas_cli.support.errors import printable

Row = Sequence[str]
INDENT = GAP = "  "


def table_text(
    title: str, header: Row, rows: Sequence[Row], width: int | None = None
) -> Iterator[str]:
    """Yield the lines of a table; names from files cannot steer the terminal."""
    lines = [[printable(str(cell)) for cell in row] for row in (header, *rows)]
    yield from table_lines(printable(title), lines if rows else [], width)


def table_lines(title: str, rows: Sequence[Row], width: int | None) -> Iterator[str]:
    """Yield the lines of a table, none longer than `width` where there is one.

    What is too wide is folded between words. Where that does not do, some columns follow below
    the others, beside what tells the rows apart; and where not even that does, each row becomes a
    block of lines `header  cell`.

    Parameters
    ----------
    title
        Stands above it.
    rows
        The header and the rows, all of them as long; nothing but the title where there are none.
    width
        Columns of the terminal, None where the output is no terminal.
    """
    yield from [title] if width is None else wrap(title, width, break_on_hyphens=False) or [""]
    if not rows:
        return
    every = list(range(len(rows[0])))
    room = math.inf if width is None else width - len(INDENT)
    if width is None or _least(rows, every) <= room:
        yield from _table(rows, every, room)
    elif parts := _parts(rows, room):
        keys = _keys(rows)
        for number, columns in enumerate(parts):
            yield from [""] if number else []
            told = [
                row
                for row in rows[1:]
                if any(row[k] for k in columns[keys:]) or not (number or any(row[keys:]))
            ]
            yield from _table([rows[0], *told], columns, room)
    else:
        yield from _blocks(rows, width)


def _words(rows: Sequence[Row], column: int) -> int:
    """Return the length of the longest word in a column."""
    return max((len(word) for row in rows for word in row[column].split()), default=0)


def _least(rows: Sequence[Row], columns: Sequence[int]) -> int:
    """Return the room that some columns need at least, folded between words."""
    return sum(_words(rows, k) for k in columns) + len(GAP) * (len(columns) - 1)


def _parts(rows: Sequence[Row], room: float) -> list[list[int]]:
    """Return the columns in parts, in each those that tell rows apart; none if too wide."""
    keys = list(range(_keys(rows)))
    parts: list[list[int]] = []
    for column in range(len(keys), len(rows[0])):
        if not parts or _natural(rows, [*parts[-1], column]) > room:
            parts.append([*keys])
        parts[-1].append(column)
    return parts if all(_least(rows, part) <= room for part in parts) else []


def _keys(rows: Sequence[Row]) -> int:
    """Return how many of the first columns are to tell the rows apart: one, or two."""
    header, *others = rows
    alike = len({row[0] for row in others}) < len(others)
    return min(1 + alike, len(header) - 1)


def _natural(rows: Sequence[Row], columns: Sequence[int]) -> int:
    """Return the room that some columns take without folding."""
    return sum(max(len(row[k]) for row in rows) for k in columns) + len(GAP) * (len(columns) - 1)


def _table(rows: Sequence[Row], columns: Sequence[int], room: float) -> Iterator[str]:
    """Yield some columns of a table, folded until there is room for them."""
    widths = [max(len(row[k]) for row in rows) for k in columns]
    narrowest = [_words(rows, k) for k in columns]
    while sum(widths) + len(GAP) * (len(widths) - 1) > room:
        giving = [k for k, width in enumerate(widths) if width > narrowest[k]]
        widths[max(giving, key=lambda k: widths[k])] -= 1
    first, *others = ([row[k] for k in columns] for row in rows)
    for row in (first, ["-" * width for width in widths], *others):
        yield from _folded(row, widths)


def _folded(row: Row, widths: Sequence[int]) -> Iterator[str]:
    """Yield the lines of one row, each cell folded between words."""
    cells = [
        [cell] if len(cell) <= width else wrap(cell, max(width, 1), break_on_hyphens=False) or [""]
        for cell, width in zip(row, widths, strict=True)
    ]
    for k in range(max(map(len, cells))):
        line = (
            (cell[k] if k < len(cell) else "").ljust(w)
            for cell, w in zip(cells, widths, strict=True)
        )
        yield INDENT + GAP.join(line).rstrip()


def _blocks(rows: Sequence[Row], width: int) -> Iterator[str]:
    """Yield each row as a block, one line or more for each cell that is not empty."""
    header, *others = rows
    longest = max(1, min(max(map(len, header)), width // 2 - len(GAP)))
    for number, row in enumerate(others):
        if number:
            yield ""
        for name, cell in zip(header, row, strict=True):
            room = width - len(INDENT) - longest - len(GAP)
            names, cells = wrap(name, longest) or [""], wrap(cell, room, break_on_hyphens=False)
            for k in range(max(len(names), len(cells)) if cells else 0):
                left = names[k] if k < len(names) else ""
                right = cells[k] if k < len(cells) else ""
                yield f"{INDENT}{left.ljust(longest)}{GAP}{right}".rstrip()
