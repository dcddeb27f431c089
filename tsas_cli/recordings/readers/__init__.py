"""One reader per file format, chosen by the suffix of a file's name."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from tsas_cli.recordings.guards.process import in_another_process
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source, Table, whole
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
_APART = {"matlab": "a MATLAB file", "mdf": "MDF"}  # their libraries crash on damaged files
_IN_PARTS = ("delimited", "parquet")
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
    return whole(batches(path, options, wanted))


def batches(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Iterator[Table]:
    """Read the wanted columns in parts of `BATCH_ROWS` rows, or whole where the format needs it.

    Raises
    ------
    InputError
        As from `read`; what is wrong further down, when that part is asked for.
    """
    if _module(path) in _IN_PARTS:
        with _checked(path) as name:
            yield from import_module(name).batches(path, options, wanted)
    else:
        yield _call("read", path, options, wanted)


def names(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of a file's columns in the order of their numbers; empty where it has none.

    Raises
    ------
    InputError
        As from `read`.
    """
    found = tuple(_call("names", path, options))
    limits.columns(found, path)
    return found


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
    """Call the module that reads the file, in another process where its library may crash."""
    with _checked(path) as name:
        kind = _APART.get(_module(path))
        if kind is not None:
            return in_another_process(name, function, path, *rest, kind=kind)
        return getattr(import_module(name), function)(path, *rest)


@contextmanager
def _checked(path: Path) -> Iterator[str]:
    """Yield the name of what reads the file; what the system says of the file is one line."""
    module = _module(path)
    try:
        limits.regular(path)
        if path.stat().st_size == 0:
            raise InputError("is empty", where=path, expected="a recording")
        yield f"{__name__}.{module}"
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error
