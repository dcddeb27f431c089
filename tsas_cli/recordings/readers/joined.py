"""One run from several files, each with a clock of its own: a `.join` file lists them."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path, PurePath

import numpy as np
from pydantic import Field, model_validator

from tsas_cli.recordings import readers
from tsas_cli.recordings.guess.words import unit_behind
from tsas_cli.recordings.manifest import read_toml
from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import ColumnSource, ReadOptions
from tsas_cli.recordings.units import conversion
from tsas_cli.recordings.validation import parse
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.plausible import SampleRate
from tsas_cli.support.strict_table import StrictTable


class JoinedFile(StrictTable):
    """One of the files: `offset_s` plus its column `time` in s is the clock of the run.

    A file without a clock has a rate in its place, by which the rows count.
    """

    file: str = Field(min_length=1)
    time: ColumnSource | None = None
    rate_Hz: SampleRate | None = None
    unit: str | None = None
    offset_s: float | None = None
    read: ReadOptions = ReadOptions()

    @model_validator(mode="after")
    def _has_one_clock(self) -> "JoinedFile":
        if (self.time is None) == (self.rate_Hz is None):
            raise ValueError("needs a time, or rate_Hz where the file has no clock")
        return self


SUFFIX = ".join"


def joined_by(path: Path) -> list[Path]:
    """Return the files that a list joins, none for another file; InputError: the list is wrong."""
    if path.suffix.lower() != SUFFIX:
        return []
    return [path.parent / part.file for part in _listed(path).values()]


def _listed(path: Path) -> dict[str, JoinedFile]:
    return {n: parse(JoinedFile, one, f"{path}, {n}") for n, one in read_toml(path).items()}


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the columns of numbers of all files as `part.column`, with the clock of their file.

    InputError: the list or a file is wrong, a file is not in the list's folder, or its clock states
    no unit or counts from its own first date and the list no offset.
    """
    parts = _listed(path).items()
    yield Offered([column for name, part in parts for column in _columns(path, name, part)])


def _columns(path: Path, name: str, part: JoinedFile) -> Iterator[Column]:
    """Yield the columns of one file besides its clock; those of text are none."""
    file = path.parent / part.file
    if PurePath(part.file).name != part.file or file.suffix.lower() == path.suffix.lower():
        raise InputError(
            f"{part.file[:80]!r} is another folder's file, or a list",
            where=f"{path}, {name}",
            expected="the name of a recording beside the list",
        )
    offset_s, times = part.offset_s or 0.0, np.zeros(0)
    if part.time is not None:
        times = _seconds(file, part.time, part, f"{path}, {name}") + offset_s
    for number, column in enumerate(readers.names(file, part.read), start=1):
        if part.time in (column, number):
            continue
        try:
            table = readers.read(file, part.read, [number])
        except InputError:
            continue
        values, unit = table.columns[number], table.units.get(number, "")
        if part.rate_Hz is not None:
            times = np.arange(values.size) / part.rate_Hz + offset_s
        own = f"{name}.{column or number}"
        yield Column(own, partial(np.asarray, values), unit, partial(np.asarray, times))


def _seconds(file: Path, clock: ColumnSource, part: JoinedFile, where: str) -> Floats:
    """Return the clock of one file, in s, without the offset."""
    table = readers.read(file, part.read, [clock])
    behind = unit_behind(clock)[1] if isinstance(clock, str) else ""
    unit = part.unit or table.units.get(clock) or behind or None
    if unit is None:
        raise InputError(f"the clock {clock} states no unit", where=where, remedy='unit = "ms"')
    if clock in table.typed and part.offset_s is None:
        raise InputError(
            f"the clock {clock} counts from the first date of its own file",
            where=where,
            remedy="offset_s = the seconds from the first file's beginning to this one's",
        )
    slope, intercept = conversion(unit, "s", where=where)
    return table.columns[clock] * slope + intercept
