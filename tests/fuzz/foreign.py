"""A reader whose library may crash: asked in its own process first, and then here as well."""

from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

import numpy as np

from tests.fuzz.rules import PLAIN, Broken, Scratch, answer
from tsas_cli.recordings.readers import names, offered, read, tables
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, ReadOptions
from tsas_cli.support.errors import InputError

_MOST_COLUMNS = 12
here_too = False  # only where coverage is measured: the library may take this process along


class Reader(Protocol):
    """What reads a format in this process: a module, or `Offering`."""

    def names(self, path: Path, options: ReadOptions) -> Sequence[str]: ...

    def read(
        self, path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
    ) -> ColumnTable: ...


class Offering:
    """The reader of a format whose module has a function `offered`."""

    def __init__(self, module: str) -> None:
        self.of = (f"{offered.__package__}.{module}", "a file")
        import_module(self.of[0])  # while it is instrumented

    def names(self, path: Path, options: ReadOptions) -> Sequence[str]:
        return offered.names(path, *self.of, options)

    def read(self, path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]) -> ColumnTable:
        return offered.read(path, *self.of, options, wanted)


def ask(reader: Reader, path: Path, options: ReadOptions) -> None:
    """Read all columns; where the library takes the file, what comes back is what is read here."""
    answer(tables, path)
    try:
        listed = names(path, options)
    except InputError as error:
        answer(_raise, error)
        if here_too and "crashed" not in error.line():
            answer(reader.names, path, options)
        return
    for said in (options, options.model_copy(update={"resample": True})):
        wanted = list(range(1, len(listed) + 1))[:_MOST_COLUMNS]
        there = answer(read, path, said, wanted)
        here = answer(reader.read, path, said, wanted) if here_too and there is not None else there
        if there is not None and (here is None or not _same(there, here)):
            raise Broken(f"{there} is {here} when it is read in this process")


def whole_file(reader: Reader, name: str) -> Callable[[bytes], None]:
    """Return the target whose input is a file of one format."""
    scratch = Scratch()
    return lambda data: ask(reader, scratch.file(name, data), PLAIN)


def files_of(name: str, *writers: Callable[[Path], Any]) -> Callable[[], Iterator[bytes]]:
    """Return the seeds of a target: what each of the writers makes of a file of this name."""

    def seeds() -> Iterator[bytes]:
        for write in writers:
            with TemporaryDirectory() as folder:
                path = Path(folder) / name
                write(path)
                yield path.read_bytes()

    return seeds


def _raise(error: InputError) -> None:
    raise error


def _same(one: ColumnTable, other: ColumnTable) -> bool:
    return one.columns.keys() == other.columns.keys() and all(
        np.array_equal(one.columns[source], other.columns[source], equal_nan=True)
        for source in one.columns
    )
