"""A run's Parquet file, read whole or by column, and validated against format 1."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow.types import is_floating, is_integer, is_null

from tsas_cli.recordings.columns import (
    BY_NAME,
    INPUTS,
    OUTPUTS,
    TIME,
    has_input_and_output,
    largest,
)
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.parquet_files import (
    ParquetSource,
    check_size,
    checked_file,
    floats_from,
    open_parquet,
    reading,
    size_of,
    unit_of,
)
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.storage import Location
from tsas_cli.recordings.units import conversion
from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import check_unchanged, state_of
from tsas_cli.support.wording import count_of


def read_recording(folder: Location, run: Run, *, strict: bool = True) -> Recording:
    """Return one run, verified by its checksum and validated against format 1.

    With `strict=False`, time may decrease or repeat, and values may be implausible, so that
    `tsas check` can describe them.

    InputError: the file is missing, leaves its folder, is not Parquet or has another checksum; a
    column is missing, in another unit, not numeric or holds an implausible value; time is not
    strictly increasing, or in implausible steps.
    """
    path = folder / run.file
    state = state_of(path) if isinstance(path, Path) and path.is_file() else None
    opened = open_run(folder, run)
    columns = opened.read_all(opened.known, strict=strict)
    if isinstance(path, Path) and state is not None:
        check_unchanged(path, state)
    return Recording(run, columns)


@dataclass(frozen=True)
class ColumnFile:
    """A Parquet file whose columns are read on demand."""

    path: Location
    file: pq.ParquetFile
    size: int

    @property
    def names(self) -> list[str]:
        """The numeric columns, in the order of the file."""
        schema = self.file.schema_arrow
        return [f.name for f in schema if f.name in BY_NAME or is_floating(f.type)]

    @property
    def known(self) -> list[str]:
        """The canonical columns, in the order of the file."""
        return [name for name in self.file.schema_arrow.names if name in BY_NAME]

    @property
    def rows(self) -> int:
        """Number of samples."""
        return int(self.file.metadata.num_rows)

    def read(self, name: str) -> Floats:
        """Return a column as float64, shape (n,), null as NaN.

        InputError: it is missing, not numeric, holds an implausible value or cannot be read; time
        is not strictly increasing, or in implausible steps.
        """
        if name not in self.names:
            raise InputError(
                f"column {name} is missing",
                where=self.path,
                remedy=f"there are: {', '.join(self.names)}",
            )
        return self.read_all([name])[name]

    def read_all(self, names: list[str], *, strict: bool = True) -> dict[str, Floats]:
        """Return columns at once; with `strict=False`, of values and times that are implausible."""
        check_size(self.file, self.path, names, size=self.size, whole=True)
        with reading(self.path):
            table = self.file.read(columns=names)
        columns = {name: floats_of(table, name, self.path) for name in names}
        if strict and TIME in columns:
            check_time(columns[TIME], self.path)
        for name, values in columns.items() if strict else ():
            check_magnitude(name, values, self.path)
        _check_sizes(columns, self.path)
        return columns


@dataclass(frozen=True)
class RunColumns(ColumnFile):
    """The file of a run."""

    run: Run


def open_run(folder: Location, run: Run) -> RunColumns:
    """Return one run, opened and validated as far as possible without reading samples.

    InputError: the file is missing, leaves its folder, is not Parquet or has another checksum; a
    column is missing or in another unit, or there are fewer than two samples.
    """
    path = folder / run.file
    opened = RunColumns(**vars(_opened(checked_file(folder, run), path)), run=run)
    _check_columns(opened.known, opened.file.schema_arrow.names, path)
    if 0 <= opened.rows < 2:  # a negative number is damage, which reading reports
        raise InputError(count_of(opened.rows, "row"), where=path, expected="at least two samples")
    return opened


def read_columns(path: Path) -> dict[str, Floats]:
    """Return the canonical columns of a Parquet file that belongs to no dataset.

    InputError: it does not exist or is no Parquet file; `time_s` is missing or does not increase; a
    column is in another unit or not numeric.
    """
    if not path.is_file():
        raise InputError("does not exist", where=path, expected="a Parquet file")
    opened = _opened(path, path)
    if TIME not in opened.known or opened.rows < 2:
        raise InputError("column time_s is missing or short", where=path, expected="time in s")
    return opened.read_all(opened.known)


def _opened(source: ParquetSource, path: Location) -> ColumnFile:
    with reading(path):
        file = open_parquet(source, path)
        _check_names_and_units(file.schema_arrow, path)
    return ColumnFile(path, file, size_of(source))


def _check_names_and_units(schema: pa.Schema, path: Location) -> None:
    """Refuse a canonical column that is duplicate, not numeric, or in another unit."""
    for field in schema:
        if field.name not in BY_NAME:
            continue
        if schema.names.count(field.name) > 1:
            raise InputError(f"duplicate column {field.name}", where=path)
        kind = field.type
        if not any(f(kind) for f in (is_floating, is_integer, is_null)):
            raise InputError(
                f"column {field.name} holds {str(kind)[:80]}", where=path, expected="float64"
            )
        unit = unit_of(field)
        expected = BY_NAME[field.name].unit
        try:
            same = not unit.strip() or conversion(unit, expected) == (1.0, 0.0)
        except InputError:
            same = False
        if not same:
            raise InputError(
                f"column {field.name} has the unit {unit[:80]}", where=path, expected=expected
            )


def floats_of(table: pa.Table, name: str, path: Location, *, first_row: int = 0) -> Floats:
    """Return a column as float64, null as NaN; `first_row` is the number of its first row.

    InputError: it is not numeric, holds an infinite value, or lacks the time of a row.
    """
    values = floats_from(table.column(name))
    is_time = name == TIME
    wrong = ~np.isfinite(values) if is_time else np.isinf(values)
    if wrong.any():
        raise InputError(
            "time_s is null or not finite" if is_time else f"{name} is infinite",
            where=f"{path}, row {first_row + int(wrong.argmax())}",
            expected="a time in s" if is_time else "a number, or null for a gap",
        )
    return values


def _check_columns(known: list[str], present: list[str], path: Location) -> None:
    """Refuse a run without time, or without an input and another column that is an output."""
    listed = ", ".join(present) or "none"
    if TIME not in known:
        raise InputError(
            "column time_s is missing",
            where=path,
            expected="time in s",
            remedy=f"there are: {listed}",
        )
    if not has_input_and_output(frozenset(known)):
        raise InputError(
            "an input and an output column are needed",
            where=path,
            expected=f"one of {', '.join(INPUTS)} and another of {', '.join(OUTPUTS)}",
            remedy=f"there are: {listed}",
        )


def _check_sizes(columns: dict[str, Floats], path: Location) -> None:
    """Refuse a channel whose largest value is implausibly small: its squares would vanish."""
    for name in columns.keys() & BY_NAME.keys() - {TIME}:
        size = np.abs(columns[name]).max(initial=0.0, where=np.isfinite(columns[name]))
        if 0.0 < size < limits.SMALLEST:
            raise InputError(
                f"{name} never exceeds {size:.3g} {BY_NAME[name].unit}",
                where=path,
                expected=f"zero, or a magnitude of at least {limits.SMALLEST:g}",
                remedy="check the unit or the factor, and ingest again",
            )


def check_time(
    time_s: Floats, path: Location, *, first_row: int = 0, began_s: float | None = None
) -> None:
    """Refuse time that does not strictly increase, or increases by implausible steps.

    `first_row` is the number of the first sample, `began_s` the start of the run, of which these
    are a piece; None at its start.
    """
    with np.errstate(over="ignore"):  # an infinite step is refused below
        step = np.diff(time_s)
    if (step <= 0).any():
        row = int(np.flatnonzero(step <= 0)[0]) + 1
        raise InputError(
            f"time_s does not increase ({time_s[row - 1]:.6g} then {time_s[row]:.6g})",
            where=f"{path}, row {first_row + row}",
            expected="strictly increasing time",
            remedy="`tsas check` describes it; correct it before ingest",
        )
    for wrong, what, expected, remedy in (
        (
            implausible(step),
            "time_s increases by",
            f"steps from {limits.SHORTEST_STEP_S:g} s to {limits.LONGEST_STEP_S:g} s",
            "check the unit of the time, and ingest again",
        ),
        (
            pauses(time_s, began_s),
            "the recording pauses for",
            f"at most {limits.LONGEST_PAUSE:g} times all the rest of it",
            "correct the clock, or split the recording there into two runs",
        ),
    ):
        if wrong.any():
            row = int(wrong.argmax()) + 1
            raise InputError(
                f"{what} {step[row - 1]:.6g} s",
                where=f"{path}, row {first_row + row}",
                expected=expected,
                remedy=remedy,
            )


def implausible(step: Floats) -> Mask:
    """Return which steps of the time no recording has."""
    return np.asarray((step < limits.SHORTEST_STEP_S) | (step > limits.LONGEST_STEP_S))


def pauses(time_s: Floats, began_s: float | None = None) -> Mask:
    """Return which step of the time is longer by far than all others since the run began."""
    with np.errstate(over="ignore", invalid="ignore"):  # an infinite step is implausible
        step = np.diff(time_s)
        rest = time_s[-1:] - (time_s[:1] if began_s is None else began_s) - step
    return np.asarray((rest > 0.0) & (step > limits.LONGEST_PAUSE * rest))


def check_magnitude(name: str, values: Floats, path: Location, *, first_row: int = 0) -> None:
    """Refuse implausible values of a column; `first_row` is the number of the first row."""
    most = largest(name)
    implausible = np.abs(values) > most
    if implausible.any():
        row = int(implausible.argmax())
        raise InputError(
            f"{name} is {values[row]:.6g}",
            where=f"{path}, row {first_row + row}",
            expected=f"a magnitude of at most {most:g} {BY_NAME[name].unit}",
            remedy="leave the cell empty where nothing was measured, or check the unit, "
            "and ingest again; `tsas check` lists such samples",
        )
