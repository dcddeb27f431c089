"""One reader per file format, chosen by the suffix of a file's name."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from tsas_cli import limits
from tsas_cli.errors import InputError
from tsas_cli.recordings.readers.options import ReadOptions
from tsas_cli.recordings.readers.table import Source, Table, whole

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
    with _reader(path) as reader:
        if hasattr(reader, "batches"):
            yield from reader.batches(path, options, wanted)
        else:
            yield reader.read(path, options, wanted)


def names(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of a file's columns in the order of their numbers; empty where it has none.

    Raises
    ------
    InputError
        As from `read`.
    """
    with _reader(path) as reader:
        found = tuple(reader.names(path, options))
    limits.columns(found, path)
    return found


@contextmanager
def _reader(path: Path) -> Iterator[Any]:
    """Yield the module that reads the file; what the system says of the file is one line."""
    module = _READERS.get(path.suffix.lower())
    if module is None:
        raise InputError(
            f"no reader knows {path.suffix or 'a name without a suffix'}",
            where=path,
            expected=f"one of {', '.join(SUFFIXES)}",
        )
    try:
        limits.regular(path)
        if path.stat().st_size == 0:
            raise InputError("is empty", where=path, expected="a recording")
        yield import_module(f"{__name__}.{module}")
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error
