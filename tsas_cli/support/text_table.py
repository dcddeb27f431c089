"""A table as lines of text, wrapped between words to fit a terminal."""

import math
from collections.abc import Iterator, Sequence
from itertools import zip_longest
from textwrap import wrap

from tsas_cli.support.errors import printable

_Row = Sequence[str]
INDENT = GAP = "  "


def table_text(
    title: str, header: _Row, rows: Sequence[_Row], width: int | None = None
) -> Iterator[str]:
    """Yield the lines of a table; control characters in names from files are escaped.

    Without rows there is only its title. Cells are wrapped between words to `width`, the columns of
    the terminal, None for other outputs; the terminal breaks lines that are still too long.
    """
    yield printable(title)
    if not rows:
        return
    cells = [[printable(str(cell)) for cell in row] for row in (header, *rows)]
    widths = _widths(cells, math.inf if width is None else width)
    for row in (cells[0], ["-" * wide for wide in widths], *cells[1:]):
        wrapped = (
            [cell] if len(cell) <= wide else wrap(cell, max(wide, 1), break_on_hyphens=False)
            for cell, wide in zip(row, widths, strict=True)
        )
        for line in zip_longest(*wrapped, fillvalue=""):
            parts = (part.ljust(wide) for part, wide in zip(line, widths, strict=True))
            yield (INDENT + GAP.join(parts)).rstrip()


def _widths(cells: Sequence[_Row], room: float) -> list[int]:
    """Return the widths of the columns; the widest are reduced, none below its longest word."""
    columns = list(zip(*cells, strict=True))
    widths = [max(map(len, column)) for column in columns]
    words = [
        max((len(word) for cell in column for word in cell.split()), default=0)
        for column in columns
    ]
    while sum(widths) + len(GAP) * len(widths) > room:
        reducible = [k for k, width in enumerate(widths) if width > words[k]]
        if not reducible:
            break
        widths[max(reducible, key=lambda k: widths[k])] -= 1
    return widths
