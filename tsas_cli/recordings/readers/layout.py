"""Layout of a text table: comment lines, names, units, delimiter and decimal mark."""

import csv
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE, BOM_UTF32_BE, BOM_UTF32_LE, getincrementaldecoder
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from tsas_cli.recordings.readers.table import ReadOptions, unit_in
from tsas_cli.recordings.readers.timebase import is_stamp
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.wording import count_of

_SAMPLE = 200  # lines of the table for the detection
_LONG = 4 * limits.LINE  # characters of them, if lines are long
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_DECIMAL_POINT = re.compile(r"(?![+-]?[1-9]\d{0,2}\.\d{3}$)[+-]?\d*\.\d+([eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")  # or three decimals
_GROUPED = {  # numbers with separators between thousands, by their decimal mark
    ".": re.compile(r"[+-]?[1-9]\d{0,2}(?:([,' \u00a0\u202f])\d{3})(?:\1\d{3})*(\.\d*)?"),
    ",": re.compile(r"[+-]?[1-9]\d{0,2}(?:([.' \u00a0\u202f])\d{3})(?:\1\d{3})*(,\d*)?"),
}
_BELOW_THOUSAND = re.compile(r"[+-]?\d{1,3}")


class DoubtfulMarkError(InputError):
    """A mark in a number is the decimal one or separates thousands; `decimal` is one answer."""

    def __init__(self, question: str, where: object, decimal: str) -> None:
        remedy = 'set decimal = "," or "." under [read] of the map: the other mark then separates '
        super().__init__(question, where=where, remedy=remedy + "thousands")
        self.decimal = decimal


@dataclass(frozen=True)
class Layout:
    """The first line of numbers (from 1), the format, and the lines above it.

    `stamps` holds the indices of the columns of dates or times of day.
    """

    delimiter: str
    decimal: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    header: tuple[str, ...]
    first_line: int
    stamps: frozenset[int] = frozenset()


def detect(path: Path, options: ReadOptions) -> Layout:
    """Return the layout of a text table, detected from its head unless the map sets it.

    Names are in the first line that is no comment, or, if that line holds numbers, in the last
    comment line if it has as many fields. A line without numbers below the names holds the units;
    else a unit in brackets at the end of a name counts.

    InputError: the file is not text in its encoding, holds no row of numbers, has more or fewer
    names than fields in a row, or its commas are ambiguous.
    """
    comments, lines = _head(path, options)
    if not lines:
        raise InputError("holds no table", where=path, expected="rows of numbers")
    if "\0" in lines[0][1]:
        raise _not_text(path, options.encoding)
    shared = (d for d in "\t;, " if all(d in text.strip(" ") for _, text in lines))
    delimiter = options.delimiter or next(shared, ",")
    rows = [fields(text, delimiter) for _, text in lines]
    limits.column_count(len(rows[0]), path)
    decimal = options.decimal or _decimal(rows, delimiter, path, options)
    names, units = [], []
    if not _has_number(rows[0], decimal):
        names = rows.pop(0)
        of_units = bool(rows) and any(rows[0]) and not _has_number(rows[0], decimal)
        if rows and (of_units if options.units_row is None else options.units_row):
            units = rows.pop(0)
    elif comments and len(last := fields(comments[-1], delimiter)) == len(rows[0]):
        names = last
    if not rows:
        raise InputError("holds no row of numbers", where=path)
    first_line = lines[len(lines) - len(rows)][0]
    names = _fitted(names, rows[0], path, first_line)
    units = [cell.strip("[]()") for cell in units] or [unit_in(name) for name in names]
    units += [""] * (len(names) - len(units))
    for (line, _), row in zip(lines[-len(rows) :], rows, strict=True):
        if len(row) != len(names):
            raise wrong_count(row, len(names), path, line)
    stamps = frozenset(i for i, cell in enumerate(rows[0]) if is_stamp(cell))
    units = ["s" if i in stamps else unit for i, unit in enumerate(units)]
    return Layout(
        delimiter, decimal, tuple(names), tuple(units), tuple(comments), first_line, stamps
    )


def wrong_count(row: Sequence[str], names: int, path: Path, line: int) -> InputError:
    """Return the error for a row with more or fewer fields than the table has names."""
    return InputError(
        count_of(len(row), "field"),
        where=f"{path}, row {line}",
        expected=f"{names}, as in the rows above",
        remedy="correct the row, or delete what is no part of the table",
    )


def encoding_of(path: Path) -> str:
    """Return UTF-32 or -16, UTF-8, or where the head is neither, that of Windows in Western Europe.

    Where all that is not ASCII are Chinese characters of two bytes, it is that of Windows there: a
    letter with an accent is one byte, and seldom stands beside another one.
    """
    with path.open("rb") as stream:
        head = stream.read(1 << 20)
    if head.startswith((BOM_UTF32_LE, BOM_UTF32_BE)):
        return "utf-32"
    if head.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        return "utf-16"
    for encoding, known_by in (("utf-8-sig", "utf-8"), ("gb18030", "gb2312")):
        try:
            getincrementaldecoder(known_by)().decode(head)
        except UnicodeError:
            continue
        return encoding
    return "cp1252"


def fields(text: str, delimiter: str) -> list[str]:
    """Return the fields of one line; repeated spaces are one delimiter."""
    if delimiter == " ":
        return text.split()
    try:
        return [cell.strip() for cell in next(csv.reader([text], delimiter=delimiter))]
    except csv.Error:  # a field that is too long: no table, as the caller will detect
        return [text]


def comment_text(line: str, options: ReadOptions) -> str | None:
    """Return the text of a comment line, or None for another line."""
    for prefix in options.comment:
        if line.lstrip().startswith(prefix):
            return line.strip().removeprefix(prefix).strip()
    return None


def number(text: str, decimal: str) -> float:
    """Return a cell as a number; ValueError if it is none or ambiguous (1.234,5)."""
    plain = text.replace(".", "·").replace(",", ".") if decimal == "," else text
    if "_" in plain:  # Python reads 1_2 as 12
        raise ValueError(text)
    return float(plain)


def grouped(text: str, decimal: str) -> float | None:
    """Return a cell with separators between thousands as a number; None for another one."""
    found = _GROUPED[decimal].fullmatch(text)
    return number(text.replace(found[1], ""), decimal) if found else None


def may_be_thousands(text: str) -> bool:
    """Return whether the comma of a number may be a thousands separator or a decimal mark."""
    return _THOUSANDS.fullmatch(text) is not None


def _head(path: Path, options: ReadOptions) -> tuple[list[str], list[tuple[int, str]]]:
    """Return the comments, and the first lines of the table with their line numbers."""
    comments: list[str] = []
    lines: list[tuple[int, str]] = []
    comment_length = table_length = 0
    for row, line in _lines(path, options):
        text = comment_text(line, options)
        if text is not None:
            comments.append(text)
            comment_length += len(text)
        elif line.strip():
            lines.append((row, line.rstrip("\r\n")))
            table_length += len(line)
        if comment_length > limits.HEADER:
            raise InputError(
                f"more than {limits.size(limits.HEADER)} of comments above the table",
                where=path,
                remedy="is this a text table? set comment under [read] of the map",
            )
        if len(lines) == _SAMPLE or table_length > _LONG:
            break
    return comments, lines


def _not_text(path: Path, encoding: str) -> InputError:
    """Return the error for a file that is not text in the encoding that was set."""
    try:
        "".encode(encoding)
    except (LookupError, ValueError):
        what, expected = f"the encoding {encoding!r} is unknown", 'one such as "utf-8" or "cp1252"'
        return InputError(what, where="read.encoding of the map", expected=expected)
    likely = encoding_of(path)
    with path.open("rb") as stream:
        is_binary = likely not in {"utf-16", "utf-32"} and b"\0" in stream.read(1 << 20)
    remedy = f'set it in the map: encoding = "{likely}" under [read]'
    if is_binary:
        remedy = f"is this a text table? its name ends in {path.suffix}"
    elif likely == encoding:
        remedy = "save it as UTF-8, or set its encoding under [read] of the map"
    return InputError(f"is not text in the encoding {encoding}", where=path, remedy=remedy)


def _lines(path: Path, options: ReadOptions) -> Iterator[tuple[int, str]]:
    """Yield the lines after those to skip, with their line numbers."""
    try:
        with path.open(encoding=options.encoding) as stream:
            numbered = enumerate(limits.lines(stream, path), start=1)
            yield from islice(numbered, options.skip_lines, None)
    except (UnicodeError, LookupError, ValueError) as error:
        raise _not_text(path, options.encoding) from error


def _decimal(
    rows: Sequence[Sequence[str]], delimiter: str, path: Path, options: ReadOptions
) -> str:
    commas, points = (
        sum(mark.fullmatch(cell) is not None for row in rows for cell in row)
        for mark in (_DECIMAL_COMMA, _DECIMAL_POINT)
    )
    if delimiter == "," or points >= commas:
        return "."
    with_comma, without = dict[int, str](), dict[int, str]()
    for _, line in _lines(path, options):  # the first rows may all exceed a thousand
        if comment_text(line, options) is not None:
            continue
        for i, cell in enumerate(fields(line, delimiter)):
            if may_be_thousands(cell):
                with_comma[i] = cell
            elif _DECIMAL_COMMA.fullmatch(cell):
                return ","
            elif _BELOW_THOUSAND.fullmatch(cell):
                without[i] = cell
    for i in with_comma.keys() & without.keys():
        raise DoubtfulMarkError(
            f"column {i + 1} holds {without[i]} and {with_comma[i]}: "
            "is the comma a decimal mark or a thousands separator?",
            path,
            ",",
        )
    return ","


def _has_number(row: Sequence[str], decimal: str) -> bool:
    for cell in row:
        try:
            number(cell, decimal)
        except ValueError:
            if grouped(cell, decimal) is None:
                continue
        return True
    return False


def _fitted(names: list[str], row: list[str], path: Path, line: int) -> list[str]:
    if not names:
        return [""] * len(row)
    if len(row) == len(names) + 1 and not row[-1]:  # a delimiter at the end of every line
        return [*names, ""]
    if len(names) != len(row):
        raise InputError(
            f"{count_of(len(names), 'column name')} and {count_of(len(row), 'field')}",
            where=f"{path}, row {line}",
            expected="as many fields as names",
            remedy="set delimiter, decimal or skip_lines under [read] of the map",
        )
    return names
