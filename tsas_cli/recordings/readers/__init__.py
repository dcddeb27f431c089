"""One reader per file format, selected by the suffix of the file name."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from tsas_cli.recordings.guards.process import in_another_process
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, ReadOptions, whole
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

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
_ISOLATED = {"matlab": "a MATLAB file", "mdf": "MDF"}  # their libraries crash on damaged files
_IN_PARTS = ("delimited", "parquet")
_WITH_TABLES = ("json_table", "matlab")
SUFFIXES = tuple(_READERS)


def read(path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]) -> ColumnTable:
    """Return the requested columns of one file.

    Raises
    ------
    InputError
        The suffix is unknown, the file is empty or damaged, or a requested column is missing or not
        numeric.
    """
    return whole(batches(path, options, wanted))


def batches(
    path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> Iterator[ColumnTable]:
    """Yield the requested columns in parts of `BATCH_ROWS` rows, or whole for some formats.

    Raises
    ------
    InputError
        As from `read`; a fault in a later part is raised with that part.
    """
    if _module(path) in _IN_PARTS:
        with _checked(path) as name:
            yield from import_module(name).batches(path, options, wanted)
    else:
        yield _call("read", path, options, wanted)


def names(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of a file's columns by number; empty text for a column without a name."""
    found = tuple(_call("names", path, options))
    limits.columns(found, path)
    return found


def tables(path: Path) -> list[str]:
    """Return the valid values of `table` in a map: the nested tables of a JSON or MATLAB file."""
    return list(_call("tables", path)) if _module(path) in _WITH_TABLES else []


def _module(path: Path) -> str:
    """Return the module that reads a file."""
    module = _READERS.get(path.suffix.lower())
    if module is None:
        raise InputError(
            f"unknown file format {path.suffix or '(no suffix)'}",
            where=path,
            expected=f"one of {', '.join(SUFFIXES)}",
        )
    return module


def _call(function: str, path: Path, *rest: Any) -> Any:
    """Return the result of a reader's function, in another process if its library may crash."""
    with _checked(path) as name:
        kind = _ISOLATED.get(_module(path))
        if kind is not None:
            return in_another_process(name, function, path, *rest, kind=kind)
        return getattr(import_module(name), function)(path, *rest)


@contextmanager
def _checked(path: Path) -> Iterator[str]:
    """Yield the name of the reader's module; errors of the system become `InputError`."""
    module = _module(path)
    try:
        limits.regular(path)
        if path.stat().st_size == 0:
            raise InputError("is empty", where=path, expected="a recording")
        yield f"{__name__}.{module}"
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error
