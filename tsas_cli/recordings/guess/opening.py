"""A file opened without a map: its numeric columns, and the options required to read it."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

from tsas_cli.recordings.guards import EncryptedError
from tsas_cli.recordings.readers import names, read, tables, text_of
from tsas_cli.recordings.readers.layout import DoubtfulMarkError, encoding_of
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, ReadOptions
from tsas_cli.support.errors import InputError

T = TypeVar("T")
Keys = dict[str, tuple[Any, str]]  # of a table of the map: value and reason
_PREAMBLE = 60  # lines above a table that are tried
_ENCODINGS = {  # that a map has to set, and why
    "utf-32": "the file begins with the byte-order mark of UTF-32",
    "utf-16": "the file begins with the byte-order mark of UTF-16",
    "cp1252": "the file is not UTF-8; cp1252 is usual on Windows",
    "gb18030": "the file is not UTF-8, and all pairs of its bytes are Chinese characters",
}


@dataclass(frozen=True)
class Opened:
    """The content of one file; the values of `asked` keys are those that it was opened with."""

    path: Path
    read: Keys  # what the file requires under `[read]`
    table: ColumnTable  # the numeric columns, all of one length, by their source in a map
    names: dict[ColumnSource, str]  # empty text for a column without one
    left_out: dict[str, str] = field(default_factory=dict)  # the other columns, and why
    asked: dict[str, str] = field(default_factory=dict)  # the keys of `read` that are questions


def open_file(path: Path) -> Opened:
    """Return a file of any supported format, opened with the options that it requires.

    InputError: the format is unknown, or the file is damaged or does not hold exactly one table.
    """
    required, asked = _table(path)
    try:
        return _opened(path, dict(required), asked)
    except DoubtfulMarkError as error:
        decimal = {"decimal": (error.decimal, "")}
        question = (
            f'{error.what} "." or "," is the decimal mark; the other one separates thousands.'
        )
        return _opened(path, required | decimal, asked | {"decimal": question})


def _opened(path: Path, required: Keys, asked: dict[str, str]) -> Opened:
    text = text_of(path, options_of(required))
    if text is not None:
        if (encoding := encoding_of(text)) in _ENCODINGS:
            required["encoding"] = (encoding, _ENCODINGS[encoding])
        required |= _preamble(path, required)
    listed = names(path, options_of(required))
    sources: dict[ColumnSource, str] = {  # by number where the name is empty or not unique
        name if name.strip("? ") and listed.count(name) == 1 else number: name
        for number, name in enumerate(listed, start=1)
    }
    table, left_out = _all_or_each(path, required, list(sources))
    if not table.columns:
        why = "".join(f" ({reason})" for reason in list(left_out.values())[:1])
        raise InputError(f"holds no column of numbers{why}", where=path)
    rows = max(values.size for values in table.columns.values())
    if rows < 2:
        raise InputError("holds one row", where=path, expected="at least two samples")
    short = {
        str(source): f"holds {values.size} numbers, others {rows}"
        for source, values in table.columns.items()
        if values.size != rows
    }
    columns = {s: v for s, v in table.columns.items() if v.size == rows}
    found = replace(table, columns=columns)
    found_names = {source: sources[source] for source in columns}
    return Opened(path, required, found, found_names, left_out | short, asked)


def options_of(required: Keys) -> ReadOptions:
    """Return the options of keys with values and reasons."""
    return ReadOptions.model_validate({key: value for key, (value, _) in required.items()})


def _table(path: Path) -> tuple[Keys, dict[str, str]]:
    """Return the key `table` if the numbers are in one of a file's tables, and the question."""
    found = tables(path)
    if not found:
        return {}, {}
    if len(found) == 1:
        return {"table": (found[0], "the only table in the file is there")}, {}
    question = (
        f"which table: {', '.join(found)}? The channels below are those of {found[0]}. If each is "
        "a run, list them (.join, docs/ingest.md)."
    )
    return {"table": (found[0], "")}, {"table": question}


def _preamble(path: Path, required: Keys) -> Keys:
    """Return the lines to skip above a text table, if columns are without names with them."""
    best, skipped, options = _named(path, required), 0, options_of(required)
    numbers = list(range(1, len(names(path, options)) + 1)) if best == 0.0 else []
    if best > 0.5 or (numbers and _tried(read, path, options, numbers) is not None):
        return {}  # a table without names is one, too
    for skip in range(1, _PREAMBLE):
        found = _named(path, required | {"skip_lines": (skip, "")})
        if found > best:
            best, skipped = found, skip
    why = f"the table begins with line {skipped + 1}"
    return {"skip_lines": (skipped, why)} if skipped else {}


def _named(path: Path, required: Keys) -> float:
    """Return the share of columns with names, −1 if there is no table.

    A title with delimiters behind it, "Bench 42;;;", names few columns.
    """
    found = _tried(names, path, options_of(required)) or ()
    return sum(map(bool, found)) / len(found) if len(found) > 1 else -1.0


def _tried(reader: Callable[..., T], *arguments: Any) -> T | None:
    """Return the result of a reader; None if it refuses the file, unless for a doubtful mark."""
    try:
        return reader(*arguments)
    except DoubtfulMarkError:
        raise
    except InputError:
        return None


def _all_or_each(
    path: Path, required: Keys, sources: list[ColumnSource]
) -> tuple[ColumnTable, dict[str, str]]:
    """Return all columns; or the readable ones, and the reason for each of the others.

    Columns that are readable by themselves but not together require `resample`.
    """
    options = options_of(required)
    if (every := _tried(read, path, options, sources)) is not None:
        return every, {}
    readable: set[ColumnSource] = set()
    left_out: dict[str, str] = {}
    for source in sources:
        try:
            read(path, options, [source])
            readable.add(source)
        except DoubtfulMarkError:
            raise
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
    together = [s for s in sources if s in readable or (s == "time" and readable)]
    try:
        return read(path, options, together), left_out
    except InputError:
        required["resample"] = (True, "the channels have clocks of their own")
        return read(path, options_of(required), together), left_out
