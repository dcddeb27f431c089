"""A dataset on disk: one Parquet file per run, and the manifest beside them (format 1)."""

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli import __version__
from tsas_cli.errors import InputError, nearest
from tsas_cli.files import sha256_of
from tsas_cli.recordings.columns import BY_NAME, INPUTS, OUTPUTS, TIME, has_input_and_output
from tsas_cli.recordings.manifest import FILE, Manifest, Run, read_manifest, write_manifest

if TYPE_CHECKING:
    import pandas as pd

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Recording:
    """One run: its manifest entry, and its columns.

    Parameters
    ----------
    run
        What the manifest says of it: conditions, file, checksum.
    columns
        By name (with the unit in it) float64 arrays of shape (n,); NaN where the file has null.
    """

    run: Run
    columns: Mapping[str, Floats]

    def __repr__(self) -> str:
        """Return a line: how many samples of which columns over which time."""
        time_s = self.time_s
        names = " ".join(self.columns)
        return f"run {self.run.id}: {time_s.size} rows, {time_s[-1] - time_s[0]:.6g} s: {names}"

    def frame(self) -> "pd.DataFrame":
        """Return the columns as a pandas table with `time_s` as its index."""
        import pandas as pd

        return pd.DataFrame(dict(self.columns)).set_index(TIME)

    @property
    def time_s(self) -> Floats:
        """Time in s, strictly increasing."""
        return self.columns[TIME]

    def get(self, name: str) -> Floats | None:
        """Return a column, or None where it was not recorded."""
        return self.columns.get(name)


@dataclass(frozen=True, repr=False)
class Dataset:
    """A dataset's folder and manifest; the recordings are read when they are asked for.

    `dataset["a"]` reads run a; a loop over the dataset reads one run after the other.

    Parameters
    ----------
    folder
        Where it is.
    manifest
        What `dataset.toml` says.
    chosen
        The ids of the runs that count, all without it.
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

    def __repr__(self) -> str:
        """Return a line: where it is, and which runs it holds."""
        return (
            f"dataset {self.manifest.name} in {self.folder}: {', '.join(r.id for r in self.runs)}"
        )

    def __getitem__(self, run: str) -> Recording:
        """Read one of the runs.

        Raises
        ------
        InputError
            There is no such run, or its file is wrong (`read_recording`).
        """
        entry = self.only([run]).runs[0]
        return read_recording(self.folder, entry)

    def __iter__(self) -> Iterator[Recording]:
        """Read one recording after the other, in the order of the manifest."""
        return (read_recording(self.folder, run) for run in self.runs)

    def header(self, stage: str, folder: Path | None) -> dict[str, Any]:
        """Return the first keys of the JSON that a stage writes into `folder`.

        Without a folder the dataset's place is said from the current one.
        """
        here = (folder or Path()).resolve()
        path = Path(os.path.relpath(self.folder.resolve(), here)).as_posix()
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


def recording_of(runs: Mapping[str, Recording], run: str) -> Recording:
    """Return a run by its id.

    Raises
    ------
    InputError
        There is none.
    """
    if run not in runs:
        raise InputError(f"there is no run {run!r}", remedy=nearest(run, runs))
    return runs[run]


def write_runs(folder: Path, runs: Mapping[str, Recording]) -> None:
    """Write runs that belong to no dataset into a new folder, one file each, NaN as null."""
    folder.mkdir()
    for name, recording in runs.items():
        columns = {n: pa.array(v, from_pandas=True) for n, v in recording.columns.items()}
        write_parquet(folder / f"{name}.parquet", pa.table(columns))


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
    return _table_of(path)


def _table_of(path: Path) -> pa.Table:
    try:
        table = pq.ParquetFile(path).read()
        _check_names_and_units(table, path)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(f"cannot be read as Parquet ({reason})", where=path) from error
    return table


def _check_names_and_units(table: pa.Table, path: Path) -> None:
    """Refuse a known column that is there twice, or whose metadata name another known unit."""
    units = {column.unit for column in BY_NAME.values()}
    for field in table.schema:
        if field.name not in BY_NAME:
            continue
        if table.column_names.count(field.name) > 1:
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
