"""Text tables: CSV, TSV and their relatives."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv

from tsas_cli.errors import InputError
from tsas_cli.recordings.readers.layout import Layout, comment_text, detect, fields, number
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Floats, Source, Table, not_a_number, resolve

_NULLS = frozenset(csv.ConvertOptions().null_values)


def read(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Table:
    """Read the wanted columns of a text table.

    Raises
    ------
    InputError
        A column is missing, a row has another number of fields, or a cell holds text.
    """
    layout = detect(path, options)
    at = resolve(wanted, layout.names, path)
    try:
        columns = _fast(path, options, layout, at)
    except pa.ArrowException:
        columns = _line_by_line(path, options, layout, at)
    units = {source: layout.units[i] for source, i in at.items() if layout.units[i]}
    return Table(columns, units, layout.header, layout.first_line)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    return detect(path, options).names


def _fast(
    path: Path, options: ReadOptions, layout: Layout, at: Mapping[Source, int]
) -> dict[Source, Floats]:
    names = [str(i) for i in range(len(layout.names))]
    table = csv.read_csv(
        path,
        csv.ReadOptions(
            skip_rows=layout.first_line - 1,
            column_names=names,
            encoding=options.encoding.removesuffix("-sig"),
        ),
        csv.ParseOptions(delimiter=layout.delimiter),
        csv.ConvertOptions(
            include_columns=[names[i] for i in sorted(set(at.values()))],
            column_types=dict.fromkeys(names, pa.float64()),
            decimal_point=layout.decimal,
            null_values=sorted(_NULLS if layout.delimiter != " " else _NULLS - {""}),
        ),
    )
    return {source: table.column(names[i]).to_numpy() for source, i in at.items()}


def _line_by_line(
    path: Path, options: ReadOptions, layout: Layout, at: Mapping[Source, int]
) -> dict[Source, Floats]:
    """Read what pyarrow refuses (aligned columns, comments between rows), or say what is wrong."""
    columns: dict[Source, list[float]] = {source: [] for source in at}
    with path.open(encoding=options.encoding) as stream:
        for row, line in enumerate(stream, start=1):
            no_row = _is_blank(line, layout) or comment_text(line, options) is not None
            if row < layout.first_line or no_row:
                continue
            cells = fields(line, layout.delimiter)
            if len(cells) != len(layout.names):
                raise InputError(
                    f"{len(cells)} fields",
                    where=f"{path}, row {row}",
                    expected=f"{len(layout.names)}, as in the rows above",
                )
            for source, i in at.items():
                columns[source].append(_cell(cells[i], layout.decimal, source, path, row))
    return {source: np.array(values) for source, values in columns.items()}


def _is_blank(line: str, layout: Layout) -> bool:
    """Say whether a line is no row; tabs alone are a row of gaps where they separate columns."""
    if line.strip():
        return False
    spaces = layout.delimiter == " " or (layout.delimiter not in line and len(layout.names) > 1)
    return spaces or not line.strip("\r\n")


def _cell(text: str, decimal: str, source: Source, path: Path, row: int) -> float:
    if text in _NULLS:
        return float("nan")
    try:
        return number(text, decimal)
    except ValueError:
        raise not_a_number(text, source, path, row) from None
