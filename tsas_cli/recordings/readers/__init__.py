"""One reader per file format, chosen by the suffix of a file's name."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from tsas_cli.errors import InputError
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
SUFFIXES = tuple(_READERS)


def read(path: Path, options: ReadOptions, wanted: Sequence[Source]) -> Table:
    """Read the wanted columns of one file with the reader for its suffix.

    Raises
    ------
    InputError
        No reader knows the suffix, the file is empty or damaged, a wanted column is missing, or
        it holds something else than numbers.
    """
    module = _READERS.get(path.suffix.lower())
    if module is None:
        raise InputError(
            f"no reader knows {path.suffix or 'a name without a suffix'}",
            where=path,
            expected=f"one of {', '.join(SUFFIXES)}",
        )
    try:
        if path.stat().st_size == 0:
            raise InputError("is empty", where=path, expected="a recording")
        table: Table = import_module(f"{__name__}.{module}").read(path, options, wanted)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error
    return table
