"""One reader per file format, chosen by the suffix of a file's name."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from tsas_cli.errors import InputError
from tsas_cli.recordings.readers.apart import in_another_process
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source, Table

_READERS = {
    ".csv": "delimited",
    ".tsv": "delimited",
    ".txt": "delimited",
    ".dat": "delimited",
    ".asc": "delimited",
    ".mat": "matlab",
    ".mf4": "mdf",
    ".mdf": "mdf",
    ".json": "json_table",
    ".parquet": "parquet",
}
_APART = {"matlab": "a MATLAB file", "mdf": "MDF"}  # their libraries crash on damaged files
_WITH_TABLES = ("json_table", "matlab")
SUFFIXES = tuple(_READERS)


def read(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Table:
    """Read the wanted columns of one file with the reader for its suffix.

    Raises
    ------
    InputError
        No reader knows the suffix, the file is empty or damaged, a wanted column is missing, or
        it holds something else than numbers.
    """
    table: Table = _call("read", path, options, wanted)
    return table


def names(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of a file's columns in the order of their numbers; empty where it has none.

    Raises
    ------
    InputError
        As from `read`.
    """
    return tuple(_call("names", path, options))


def tables(path: Path) -> list[str]:
    """Return what `table` in a map may name: where tables stand deeper in a JSON or MATLAB file.

    Raises
    ------
    InputError
        As from `read`.
    """
    return list(_call("tables", path)) if _module(path) in _WITH_TABLES else []


def _module(path: Path) -> str:
    """Return the module that reads a file."""
    module = _READERS.get(path.suffix.lower())
    if module is None:
        raise InputError(
            f"no reader knows {path.suffix or 'a name without a suffix'}",
            where=path,
            expected=f"one of {', '.join(SUFFIXES)}",
        )
    return module


def _call(function: str, path: Path, *rest: Any) -> Any:
    """Call the module that reads the file; what the system says of the file is one line."""
    module = _module(path)
    name = f"{__name__}.{module}"
    try:
        if path.stat().st_size == 0:
            raise InputError("is empty", where=path, expected="a recording")
        if module in _APART:
            return in_another_process(name, function, path, *rest, kind=_APART[module])
        return getattr(import_module(name), function)(path, *rest)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error
