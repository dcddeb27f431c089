"""A file opened without a map: its numeric columns, and the options required to read it."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tsas_cli.recordings.guards.damaged import EncryptedError
from tsas_cli.recordings.readers import names, read, tables, text_of
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, ReadOptions
from tsas_cli.support.errors import InputError

_PREAMBLE = 60  # lines above a table that are tried


@dataclass(frozen=True)
class Opened:
    """The content of one file.

    Attributes
    ----------
    read
        The keys of `[read]` that the file requires, each with value and reason.
    table
        The numeric columns, all of one length, by their source in a map.
    names
        Their names; empty text for a column without one.
    left_out
        The other columns, and the reason for each.
    """

    path: Path
    read: dict[str, tuple[Any, str]]
    table: ColumnTable
    names: dict[ColumnSource, str]
    left_out: dict[str, str] = field(default_factory=dict)


def open_file(path: Path) -> Opened:
    """Return a file of any supported format, opened with the options that it requires.

    Raises
    ------
    InputError
        The format is unknown, or the file is damaged or does not hold exactly one table.
    """
    required = dict(_table(path))
    text = text_of(path, _options(required))
    if text is not None:
        required |= dict(_encoding(text))
        required |= _preamble(path, required)
    options = _options(required)
    listed = names(path, options)
    sources = {_source(listed, i): name for i, name in enumerate(listed)}
    table, left_out = _all_or_each(path, options, list(sources))
    if table is None:
        required["resample"] = (True, "the channels have clocks of their own")
        table, left_out = _all_or_each(path, _options(required), list(sources), each=True)
    if table is None or not table.columns:
        why = "".join(f" ({reason})" for reason in list(left_out.values())[:1])
        raise InputError(f"holds no column of numbers{why}", where=path)
    columns, short = _longest(table)
    if next(iter(columns.values())).size < 2:
        raise InputError("holds one row", where=path, expected="at least two samples")
    found = replace(table, columns=columns)
    found_names = {source: sources[source] for source in columns}
    return Opened(path, required, found, found_names, left_out | short)


def _options(required: dict[str, tuple[Any, str]]) -> ReadOptions:
    return ReadOptions.model_validate({key: value for key, (value, _) in required.items()})


def _source(listed: tuple[str, ...], i: int) -> ColumnSource:
    """Return the name of a column, or its number if the name is empty or not unique."""
    name = listed[i]
    return name if name.strip("? ") and listed.count(name) == 1 else i + 1


def _encoding(path: Path) -> Iterator[tuple[str, tuple[Any, str]]]:
    with path.open("rb") as stream:
        head = stream.read(1 << 16)
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        yield "encoding", ("utf-16", "the file begins with the byte-order mark of UTF-16")
    elif not _is_utf_8(head):
        yield "encoding", ("cp1252", "the file is not UTF-8; cp1252 is usual on Windows")


def _is_utf_8(head: bytes) -> bool:
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        return error.start > len(head) - 4  # a character that is cut at the end of the head
    return True


def _table(path: Path) -> Iterator[tuple[str, tuple[Any, str]]]:
    """Yield the key `table` if the numbers are nested in a JSON or MATLAB file."""
    found = tables(path)
    if len(found) > 1:
        raise InputError(
            f"holds {len(found)} tables: {', '.join(found)}",
            where=path,
            expected="one",
            remedy='write a map by hand, with table = "…" under [read] (docs/ingest.md)',
        )
    if found:
        yield "table", (found[0], "the only table in the file is there")


def _preamble(path: Path, required: dict[str, tuple[Any, str]]) -> dict[str, tuple[Any, str]]:
    """Return the lines to skip above a text table, if it cannot be read with them."""
    if _columns_in(path, required) > 1:
        return {}
    for skip in range(1, _PREAMBLE):
        key = {"skip_lines": (skip, f"the table begins with line {skip + 1}")}
        if _columns_in(path, required | key) > 1:
            return key
    return {}


def _columns_in(path: Path, required: dict[str, tuple[Any, str]]) -> int:
    try:
        return len(names(path, _options(required)))
    except InputError:
        return 0


def _all_or_each(
    path: Path, options: ReadOptions, sources: list[ColumnSource], *, each: bool = False
) -> tuple[ColumnTable | None, dict[str, str]]:
    """Return all columns; or the readable ones, and the reason for each of the others.

    None if every column is readable by itself but not all of them together.
    """
    try:
        return read(path, options, sources), {}
    except InputError:
        tables: dict[ColumnSource, ColumnTable] = {}
        left_out: dict[str, str] = {}
        for source in sources:
            try:
                tables[source] = read(path, options, [source])
            except EncryptedError as error:
                raise InputError(
                    f"column {source} is encrypted",
                    where=path,
                    expected="columns that can be read",
                    remedy="decrypt it, or write a map by hand without it (docs/ingest.md)",
                ) from error
            except InputError as error:
                if source != "time":
                    left_out[str(source)] = error.what
    try:
        together = [s for s in sources if s in tables or (s == "time" and tables)]
        return read(path, options, together), left_out
    except InputError:
        if each:
            raise
        return None, {}


def _longest(table: ColumnTable) -> tuple[dict[ColumnSource, Any], dict[str, str]]:
    """Return the columns as long as the longest one, and the reason for each of the others."""
    rows = max(values.size for values in table.columns.values())
    short = {
        str(source): f"holds {values.size} numbers, others {rows}"
        for source, values in table.columns.items()
        if values.size != rows
    }
    return {s: v for s, v in table.columns.items() if v.size == rows}, short
