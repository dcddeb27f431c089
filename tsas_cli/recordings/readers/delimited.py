"""Text tables: CSV, TSV and similar formats."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import csv

from tsas_cli.recordings.arrow_columns import floats_from
from tsas_cli.recordings.readers.layout import Layout, comment_text, detect, fields, number
from tsas_cli.recordings.readers.table import (
    BATCH_ROWS,
    ColumnSource,
    ColumnTable,
    ReadOptions,
    in_batches,
    not_a_number,
    resolve,
)
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

_NULLS = frozenset(csv.ConvertOptions().null_values)


def batches(
    path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> Iterator[ColumnTable]:
    """Yield the requested columns of a text table in parts.

    From a row that pyarrow refuses, or with a delimiter outside ASCII, it is read line by line.

    Raises
    ------
    InputError
        A column is missing, a row differs in its number of fields, or a cell holds text.
    """
    layout = detect(path, options)
    at = resolve(wanted, layout.names, path)
    units = {source: layout.units[i] for source, i in at.items() if layout.units[i]}
    rows = 0
    try:
        for table in in_batches(_fast(path, options, layout, at)):
            columns = {source: floats_from(table.column(str(i))) for source, i in at.items()}
            yield ColumnTable(columns, units, layout.header, layout.first_line + rows)
            rows += table.num_rows
    except pa.ArrowException:
        lines = islice(_line_by_line(path, options, layout, at), rows, None)
        while part := list(islice(lines, BATCH_ROWS)):
            values = dict(zip(at, np.ascontiguousarray(np.transpose(part)), strict=True))
            yield ColumnTable(values, units, layout.header, layout.first_line + rows)
            rows += len(part)


def names(path: Path, options: ReadOptions) -> Sequence[str]:
    """Return the names of the columns."""
    return detect(path, options).names


def _fast(
    path: Path, options: ReadOptions, layout: Layout, at: Mapping[ColumnSource, int]
) -> csv.CSVStreamingReader:
    if not layout.delimiter.isascii():
        raise pa.ArrowInvalid(layout.delimiter)  # pyarrow would raise a bare ValueError
    names = [str(i) for i in range(len(layout.names))]
    return csv.open_csv(
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


def _line_by_line(
    path: Path, options: ReadOptions, layout: Layout, at: Mapping[ColumnSource, int]
) -> Iterator[list[float]]:
    """Yield the rows that pyarrow refuses (aligned columns, comments), or raise `InputError`."""
    with path.open(encoding=options.encoding) as stream:
        for row, line in enumerate(limits.lines(stream, path), start=1):
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
            yield [_cell(cells[i], layout.decimal, source, path, row) for source, i in at.items()]


def _is_blank(line: str, layout: Layout) -> bool:
    """Return whether a line is blank; delimiters alone are a row of gaps."""
    if line.strip():
        return False
    spaces = layout.delimiter == " " or (layout.delimiter not in line and len(layout.names) > 1)
    return spaces or not line.strip("\r\n")


def _cell(text: str, decimal: str, source: ColumnSource, path: Path, row: int) -> float:
    if text in _NULLS:
        return float("nan")
    try:
        return number(text, decimal)
    except ValueError:
        raise not_a_number(text, source, path, row) from None
