"""A table as lines of text: as wide as it is, or folded between words to fit a terminal."""

import math
from collections.abc import Iterator, Sequence
from itertools import zip_longest
from textwrap import wrap

from tsas_cli.support.errors import printable

Row = Sequence[str]
INDENT = GAP = "  "


def table_text(
    title: str, header: Row, rows: Sequence[Row], width: int | None = None
) -> Iterator[str]:
    """Yield the lines of a table; names from files cannot steer the terminal.

    Parameters
    ----------
    title
        Stands above it, alone where there are no rows.
    header, rows
        Cells, as many in each row.
    width
        Columns of the terminal, None where the output is no terminal. Cells are folded as far as
        their words allow; a terminal breaks the lines that are still too long.
    """
    yield printable(title)
    if not rows:
        return
    cells = [[printable(str(cell)) for cell in row] for row in (header, *rows)]
    widths = _widths(cells, math.inf if width is None else width)
    for row in (cells[0], ["-" * wide for wide in widths], *cells[1:]):
        yield from _lines(row, widths)


def _widths(cells: Sequence[Row], room: float) -> list[int]:
    """Return the widths of the columns; the widest give way, none below its longest word."""
    columns = list(zip(*cells, strict=True))
    widths = [max(map(len, column)) for column in columns]
    words = [
        max((len(word) for cell in column for word in cell.split()), default=0)
        for column in columns
    ]
    while sum(widths) + len(GAP) * len(widths) > room:
        giving = [k for k, width in enumerate(widths) if width > words[k]]
        if not giving:
            break
        widths[max(giving, key=lambda k: widths[k])] -= 1
    return widths


def _lines(row: Row, widths: Sequence[int]) -> Iterator[str]:
    """Yield the lines of one row."""
    folded = (
        [cell] if len(cell) <= width else wrap(cell, max(width, 1), break_on_hyphens=False)
        for cell, width in zip(row, widths, strict=True)
    )
    for line in zip_longest(*folded, fillvalue=""):
        parts = (part.ljust(width) for part, width in zip(line, widths, strict=True))
        yield (INDENT + GAP.join(parts)).rstrip()
