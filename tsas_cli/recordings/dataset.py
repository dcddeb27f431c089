"""A dataset on disk: one Parquet file per run, and the manifest beside them (format 1)."""

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli import __version__
from tsas_cli.errors import InputError, nearest
from tsas_cli.files import sha256_of
from tsas_cli.recordings.columns import BY_NAME, INPUTS, OUTPUTS, TIME, has_input_and_output
from tsas_cli.recordings.manifest import FILE, Manifest, Run, read_manifest, write_manifest

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Recording:
    """One run: its manifest entry, and its canonical columns as float64 arrays, null as NaN."""

    run: Run
    columns: Mapping[str, Floats]

    @property
    def time_s(self) -> Floats:
        """Time in s, strictly increasing."""
        return self.columns[TIME]

    def get(self, name: str) -> Floats | None:
        """Return a column, or None where it was not recorded."""
        return self.columns.get(name)


@dataclass(frozen=True)
class Dataset:
    """A dataset's folder and manifest; the recordings are read when they are asked for.

    `chosen` holds the ids of the runs that count, all without it.
    """

    folder: Path
    manifest: Manifest
    chosen: tuple[str, ...] | None = None

    @property
    def runs(self) -> list[Run]:
        """The runs that count, in the order of the manifest."""
        return [r for r in self.manifest.run if self.chosen is None or r.id in self.chosen]

    def only(self, ids: Iterable[str]) -> "Dataset":
        """Return the same dataset with these runs alone.

        Raises
        ------
        InputError
            There is no such run.
        """
        known = [run.id for run in self.manifest.run]
        chosen = tuple(ids)
        for name in chosen:
            if name not in known:
                raise InputError(
                    f"there is no run {name!r}",
                    where=self.folder / FILE,
                    remedy=nearest(name, known),
                )
        return replace(self, chosen=chosen)

    def __iter__(self) -> Iterator[Recording]:
        """Read one recording after the other, in the order of the manifest."""
        return (read_recording(self.folder, run) for run in self.runs)

    def header(self, stage: str, folder: Path) -> dict[str, Any]:
        """Return the first keys of the JSON that a stage writes into `folder`."""
        path = Path(os.path.relpath(self.folder.resolve(), folder.resolve())).as_posix()
        return {
            "format": 1,
            "stage": stage,
            "version": __version__,
            "dataset": {"name": self.manifest.name, "folder": path, "hashes": self.hashes()},
        } | ({} if self.chosen is None else {"chosen": [run.id for run in self.runs]})

    def hashes(self) -> dict[str, str]:
        """Return the checksum of the manifest and of each run's file, by path in the dataset."""
        return {FILE: sha256_of(self.folder / FILE)} | {r.file: r.sha256 for r in self.manifest.run}


def read_dataset(folder: Path) -> Dataset:
    """Open a dataset.

    Raises
    ------
    InputError
        The folder holds no manifest, or one that format 1 does not allow.
    """
    return Dataset(folder, read_manifest(folder))


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
            raise _not_parquet(self.path, error) from error
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
        raise _not_parquet(path, error) from error
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


def write_dataset(folder: Path, manifest: Manifest, tables: Mapping[str, pa.Table]) -> None:
    """Write the runs' tables and the manifest with their checksums into an empty folder."""
    runs = tuple(write_run(folder, run, tables[run.id]) for run in manifest.run)
    write_manifest(folder, manifest.model_copy(update={"run": runs}))


def write_run(folder: Path, run: Run, table: pa.Table) -> Run:
    """Write one run's table into a dataset's folder; return the run with its checksum."""
    path = folder / run.file
    path.parent.mkdir(exist_ok=True)
    write_parquet(path, table)
    return run.model_copy(update={"sha256": sha256_of(path)})


def write_parquet(path: Path, table: pa.Table) -> None:
    """Write a table of float64 columns; known columns get their unit as field metadata."""
    fields = [
        field.with_metadata({"unit": BY_NAME[field.name].unit}) if field.name in BY_NAME else field
        for field in table.schema
    ]
    pq.write_table(
        table.cast(pa.schema(fields)),
        path,
        compression="zstd",
        use_dictionary=False,
        use_byte_stream_split=_float_names(table),
    )


def _float_names(table: pa.Table) -> list[str]:
    return [f.name for f in table.schema if pa.types.is_floating(f.type)]


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
        raise _not_parquet(path, error) from error
    return table


def _not_parquet(path: Path, error: Exception) -> InputError:
    reason = str(error).splitlines()[0]
    return InputError(f"cannot be read as Parquet ({reason})", where=path)


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
