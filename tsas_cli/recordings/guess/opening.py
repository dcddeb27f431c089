"""A file opened without a map: its columns of numbers, and what had to be said to read it."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tsas_cli.recordings.readers import names, read, tables
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source, Table
from tsas_cli.support.errors import InputError

_TEXT = (".csv", ".tsv", ".txt", ".dat", ".asc")
_PREAMBLE = 60  # lines above a table that are tried


@dataclass(frozen=True)
class Opened:
    """What one file holds.

    Attributes
    ----------
    read
        The keys of `[read]` that the file needs, each with its value and the reason.
    table
        The columns of numbers, all of one length, by the source that a map names them with.
    names
        Their names; empty text where a column has none.
    left_out
        The other columns, and why they cannot be taken.
    """

    path: Path
    read: dict[str, tuple[Any, str]]
    table: Table
    names: dict[Source, str]
    left_out: dict[str, str] = field(default_factory=dict)


def open_file(path: Path) -> Opened:
    """Open a file of any format that ingest reads, and find out how.

    Raises
    ------
    InputError
        No reader knows it, it is damaged, it holds no table, or more than one.
    """
    said = dict(_encoding(path)) | dict(_table(path))
    said |= _preamble(path, said)
    options = _options(said)
    listed = names(path, options)
    sources = {_source(listed, i): name for i, name in enumerate(listed)}
    table, left_out = _all_or_each(path, options, list(sources))
    if table is None:
        said["resample"] = (True, "the channels have clocks of their own")
        table, left_out = _all_or_each(path, _options(said), list(sources), each=True)
    if table is None or not table.columns:
        why = "".join(f" ({reason})" for reason in list(left_out.values())[:1])
        raise InputError(f"holds no column of numbers{why}", where=path)
    columns, short = _longest(table)
    if next(iter(columns.values())).size < 2:
        raise InputError("holds one row", where=path, expected="at least two samples")
    found = replace(table, columns=columns)
    kept = {source: sources[source] for source in columns}
    return Opened(path, said, found, kept, left_out | short)


def _options(said: dict[str, tuple[Any, str]]) -> ReadOptions:
    return ReadOptions.model_validate({key: value for key, (value, _) in said.items()})


def _source(listed: tuple[str, ...], i: int) -> Source:
    """Return the name, or the number where there is no name or one that is not unique."""
    name = listed[i]
    return name if name.strip("? ") and listed.count(name) == 1 else i + 1


def _encoding(path: Path) -> Iterator[tuple[str, tuple[Any, str]]]:
    if path.suffix.lower() not in _TEXT or not path.is_file():
        return
    with path.open("rb") as stream:
        head = stream.read(1 << 16)
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        yield "encoding", ("utf-16", "the file begins with the mark of UTF-16")
    elif not _is_utf_8(head):
        yield "encoding", ("cp1252", "the file is not UTF-8; cp1252 is usual on Windows")


def _is_utf_8(head: bytes) -> bool:
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        return error.start > len(head) - 4  # a letter that the head cuts in two
    return True


def _table(path: Path) -> Iterator[tuple[str, tuple[Any, str]]]:
    """Yield the key `table` where the numbers stand deeper in a JSON or MATLAB file."""
    found = tables(path)
    if len(found) > 1:
        raise InputError(
            f"holds {len(found)} tables: {', '.join(found)}",
            where=path,
            expected="one",
            remedy='write a map by hand, with table = "…" under [read] (docs/ingest.md)',
        )
    if found:
        yield "table", (found[0], "the only table in the file stands there")


def _preamble(path: Path, said: dict[str, tuple[Any, str]]) -> dict[str, tuple[Any, str]]:
    """Return how many lines stand above a text table, where they keep it from being read."""
    if path.suffix.lower() not in _TEXT or _columns_in(path, said) > 1:
        return {}
    for skip in range(1, _PREAMBLE):
        key = {"skip_lines": (skip, f"the table begins with line {skip + 1}")}
        if _columns_in(path, said | key) > 1:
            return key
    return {}


def _columns_in(path: Path, said: dict[str, tuple[Any, str]]) -> int:
    try:
        return len(names(path, _options(said)))
    except InputError:
        return 0


def _all_or_each(
    path: Path, options: ReadOptions, sources: list[Source], *, each: bool = False
) -> tuple[Table | None, dict[str, str]]:
    """Return all columns, or, where one cannot be read, those that can and why others cannot.

    None where every column can be read alone but not all of them together.
    """
    try:
        return read(path, options, sources), {}
    except InputError:
        tables: dict[Source, Table] = {}
        left_out: dict[str, str] = {}
        for source in sources:
            try:
                tables[source] = read(path, options, [source])
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


def _longest(table: Table) -> tuple[dict[Source, Any], dict[str, str]]:
    """Return the columns with as many rows as the longest, and why the others are left out."""
    rows = max(values.size for values in table.columns.values())
    short = {
        str(source): f"holds {values.size} numbers, others {rows}"
        for source, values in table.columns.items()
        if values.size != rows
    }
    return {s: v for s, v in table.columns.items() if v.size == rows}, short
