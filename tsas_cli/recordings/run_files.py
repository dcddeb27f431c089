"""A run's Parquet file, read whole or a column at a time, and checked against format 1."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.errors import InputError
from tsas_cli.files import sha256_of
from tsas_cli.recordings.columns import BY_NAME, INPUTS, OUTPUTS, TIME, has_input_and_output
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.readers.table import damaged
from tsas_cli.recordings.recording import Recording

Floats = npt.NDArray[np.float64]


def read_recording(folder: Path, run: Run, *, strict: bool = True) -> Recording:
    """Read one run and check it against its checksum and the rules of format 1.

    With `strict=False` the time may run backwards or repeat, for `tsas check` to describe it.

    Raises
    ------
    InputError
        The file is missing, leaves its folder, is not Parquet or has another checksum; a column
        is missing, in another unit or not of numbers; the time is not strictly increasing.
    """
    path = folder / run.file
    table = _read_parquet(path, folder, run)
    columns = {name: _floats(table, name, path) for name in table.column_names if name in BY_NAME}
    _check_columns(columns, table.column_names, path)
    if strict:
        _check_time(columns[TIME], path)
    return Recording(run, columns)


@dataclass(frozen=True)
class RunColumns:
    """One run, whose columns are read one at a time, when they are asked for."""

    run: Run
    path: Path
    file: pq.ParquetFile

    @property
    def names(self) -> list[str]:
        """The columns of numbers, in the order of the file."""
        schema = self.file.schema_arrow
        return [f.name for f in schema if f.name in BY_NAME or pa.types.is_floating(f.type)]

    @property
    def rows(self) -> int:
        """How many samples there are."""
        return int(self.file.metadata.num_rows)

    def read(self, name: str) -> Floats:
        """Read a column as float64, shape (n,), null as NaN.

        Raises
        ------
        InputError
            It is not there, not of numbers, or cannot be read; the time is not strictly increasing.
        """
        if name not in self.names:
            raise InputError(
                f"column {name} is missing",
                where=self.path,
                remedy=f"there are: {', '.join(self.names)}",
            )
        try:
            table = self.file.read(columns=[name])
        except (pa.ArrowException, OSError) as error:
            raise damaged(self.path, "Parquet", error) from error
        values = _floats(table, name, self.path)
        if name == TIME:
            _check_time(values, self.path)
        return values


def open_run(folder: Path, run: Run) -> RunColumns:
    """Open one run and check it as far as that is possible without its samples.

    Raises
    ------
    InputError
        The file is missing, leaves its folder, is not Parquet or has another checksum; the time is
        missing, or a column is in another unit.
    """
    path = folder / run.file
    _check_file(path, folder, run)
    try:
        file = pq.ParquetFile(path)
        _check_names_and_units(file.schema_arrow, path)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise damaged(path, "Parquet", error) from error
    if TIME not in file.schema_arrow.names or file.metadata.num_rows < 2:
        raise InputError("column time_s is missing or short", where=path, expected="time in s")
    return RunColumns(run, path, file)


def read_columns(path: Path) -> dict[str, Floats]:
    """Read the canonical columns of a Parquet file that belongs to no dataset.

    Raises
    ------
    InputError
        It is not there or not Parquet; `time_s` is missing or does not increase; a column is in
        another unit or not of numbers.
    """
    if not path.is_file():
        raise InputError("is not there", where=path, expected="a Parquet file")
    table = _table_of(path)
    columns = {name: _floats(table, name, path) for name in table.column_names if name in BY_NAME}
    if TIME not in columns or len(columns[TIME]) < 2:
        raise InputError("column time_s is missing or short", where=path, expected="time in s")
    _check_time(columns[TIME], path)
    return columns


def _read_parquet(path: Path, folder: Path, run: Run) -> pa.Table:
    _check_file(path, folder, run)
    return _table_of(path)


def _check_file(path: Path, folder: Path, run: Run) -> None:
    """Refuse a file that is not there, not in the dataset, or not what the manifest says."""
    if not path.is_file():
        raise InputError(
            "the run's file is missing", where=path, expected=f"the Parquet file of run {run.id}"
        )
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError("a link leads out of the dataset's folder", where=path)
    try:
        digest = sha256_of(path)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    if digest != run.sha256.lower():
        raise InputError(
            "the checksum differs from the manifest's",
            where=path,
            expected=run.sha256.lower(),
            remedy="the file has changed since ingest: restore it or ingest again",
        )


def _table_of(path: Path) -> pa.Table:
    try:
        table = pq.ParquetFile(path).read()
        _check_names_and_units(table.schema, path)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise damaged(path, "Parquet", error) from error
    return table


def _check_names_and_units(schema: pa.Schema, path: Path) -> None:
    """Refuse a known column that is there twice, or whose metadata name another known unit."""
    units = {column.unit for column in BY_NAME.values()}
    for field in schema:
        if field.name not in BY_NAME:
            continue
        if schema.names.count(field.name) > 1:
            raise InputError(f"column {field.name} is there twice", where=path)
        unit = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        expected = BY_NAME[field.name].unit
        if unit in units - {expected}:
            raise InputError(
                f"column {field.name} says that its unit is {unit}", where=path, expected=expected
            )


def _floats(table: pa.Table, name: str, path: Path) -> Floats:
    column = table.column(name)
    if not (
        pa.types.is_floating(column.type)
        or pa.types.is_integer(column.type)
        or pa.types.is_null(column.type)
    ):
        raise InputError(f"column {name} holds {column.type}", where=path, expected="float64")
    values: Floats = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    if name == TIME and not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values))[0])
        raise InputError(
            "time_s is null or not finite", where=f"{path}, row {row}", expected="a time in s"
        )
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size:
        raise InputError(
            f"{name} is infinite",
            where=f"{path}, row {infinite[0]}",
            expected="a number, or null for a gap",
        )
    return values


def _check_columns(columns: Mapping[str, Floats], there: list[str], path: Path) -> None:
    listed = ", ".join(there) or "none"
    if TIME not in columns:
        raise InputError(
            "column time_s is missing",
            where=path,
            expected="time in s",
            remedy=f"there are: {listed}",
        )
    if not has_input_and_output(frozenset(columns)):
        raise InputError(
            "an input and an output column are needed",
            where=path,
            expected=f"one of {', '.join(INPUTS)} and another of {', '.join(OUTPUTS)}",
            remedy=f"there are: {listed}",
        )
    if len(columns[TIME]) < 2:
        raise InputError(f"{len(columns[TIME])} rows", where=path, expected="at least two samples")


def _check_time(time_s: Floats, path: Path) -> None:
    step = np.diff(time_s)
    if (step <= 0).any():
        row = int(np.flatnonzero(step <= 0)[0]) + 1
        raise InputError(
            f"time_s does not increase ({time_s[row - 1]:.6g} then {time_s[row]:.6g})",
            where=f"{path}, row {row}",
            expected="strictly increasing time",
            remedy="`tsas check` describes it; mend it before ingest",
        )
