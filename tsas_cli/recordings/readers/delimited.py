"""Text tables: CSV, TSV and similar formats."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from tsas_cli.recordings.parquet_files import floats_from, in_batches
from tsas_cli.recordings.readers.layout import (
    DoubtfulMarkError,
    Layout,
    comment_text,
    detect,
    fields,
    grouped,
    number,
    wrong_count,
)
from tsas_cli.recordings.readers.table import (
    BATCH_ROWS,
    ColumnSource,
    ColumnTable,
    ReadOptions,
    not_a_number,
    resolve,
)
from tsas_cli.recordings.readers.timebase import Seconds, is_stamp
from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats

_NULLS = frozenset(csv.ConvertOptions().null_values)


def batches(
    path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> Iterator[ColumnTable]:
    """Yield the requested columns of a text table in parts.

    Dates become seconds since the first one in their column, times of day seconds since midnight.
    From a row that pyarrow refuses, or with a delimiter outside ASCII, it is read line by line.

    InputError: a column is missing, a row differs in its number of fields, or a cell holds text.
    """
    layout = detect(path, options)
    at = resolve(wanted, layout.names, path)
    units = {source: layout.units[i] for source, i in at.items() if layout.units[i]}
    seconds = {source: Seconds() for source, i in at.items() if i in layout.stamps}
    rows = 0

    def part(columns: Mapping[ColumnSource, Any], count: int) -> ColumnTable:
        nonlocal rows
        first = layout.first_line + rows
        rows += count
        stamped = {s: _stamps(columns[s], seconds[s], s, path, first) for s in seconds}
        values = {**columns, **stamped}
        return ColumnTable(values, units, layout.header, first, frozenset(seconds))

    try:
        for table in in_batches(_fast(path, options, layout, at), BATCH_ROWS):
            found = {source: table.column(str(i)) for source, i in at.items()}
            columns = {s: c if s in seconds else floats_from(c) for s, c in found.items()}
            yield part(columns, table.num_rows)
    except pa.ArrowException:
        lines = islice(_line_by_line(path, options, layout, at), rows, None)
        while cells := list(islice(lines, BATCH_ROWS)):
            values = dict(zip(at, zip(*cells, strict=True), strict=True))
            columns = {s: v if s in seconds else np.array(v) for s, v in values.items()}
            yield part(columns, len(cells))


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
            column_types={
                name: pa.string() if i in layout.stamps else pa.float64()
                for i, name in enumerate(names)
            },
            strings_can_be_null=True,
            decimal_point=layout.decimal,
            null_values=sorted(_NULLS if layout.delimiter != " " else _NULLS - {""}),
        ),
    )


def _line_by_line(
    path: Path, options: ReadOptions, layout: Layout, at: Mapping[ColumnSource, int]
) -> Iterator[list[float | str]]:
    """Yield the rows that pyarrow refuses (aligned columns, comments), or raise `InputError`."""
    with path.open(encoding=options.encoding) as stream:
        for row, line in enumerate(limits.lines(stream, path), start=1):
            no_row = _is_blank(line, layout) or comment_text(line, options) is not None
            if row < layout.first_line or no_row:
                continue
            cells = fields(line, layout.delimiter)
            if len(cells) != len(layout.names):
                raise wrong_count(cells, len(layout.names), path, row)
            yield [
                _cell(cells[i], source, options, layout, path, row)
                if i not in layout.stamps
                else cells[i]
                for source, i in at.items()
            ]


def _stamps(column: Any, convert: Seconds, source: ColumnSource, path: Path, first: int) -> Floats:
    """Return dates or times of day in seconds; `first` is the number of their first row."""
    cells = column.to_pylist() if isinstance(column, pa.ChunkedArray) else column
    cells = [None if cell is None or cell in _NULLS else cell.strip() for cell in cells]
    try:
        return convert.from_text(cells)
    except ValueError as error:
        row, cell = next(
            ((row, cell) for row, cell in enumerate(cells, first) if cell and not is_stamp(cell)),
            (first, "dates or times of several forms"),
        )
        raise not_a_number(cell, source, path, row) from error


def _is_blank(line: str, layout: Layout) -> bool:
    """Return whether a line is blank; delimiters alone are a row of gaps."""
    if line.strip():
        return False
    spaces = layout.delimiter == " " or (layout.delimiter not in line and len(layout.names) > 1)
    return spaces or not line.strip("\r\n")


def _cell(
    text: str, source: ColumnSource, options: ReadOptions, layout: Layout, path: Path, row: int
) -> float:
    if text in _NULLS:
        return float("nan")
    try:
        return number(text, layout.decimal)
    except ValueError:
        value = grouped(text, layout.decimal)
    if value is None:
        raise not_a_number(text, source, path, row)
    if options.decimal is None:
        question = f"column {source} holds {text!r}: are thousands separated in it?"
        raise DoubtfulMarkError(question, f"{path}, row {row}", layout.decimal)
    return value
