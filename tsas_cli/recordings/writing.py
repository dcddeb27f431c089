"""Runs and datasets that are written; results of stages, `runs/ID.parquet`, read again."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Manifest, Run, check_run_name, write_manifest
from tsas_cli.recordings.parquet_files import (
    check_size,
    column_of,
    floats_from,
    open_parquet,
    reading,
)
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import read_columns
from tsas_cli.recordings.storage import is_inside
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of
from tsas_cli.support.wording import count_of


@dataclass(frozen=True)
class WrittenRuns(Mapping[str, Recording]):
    """Runs that a stage has written into a folder, each read on access."""

    folder: Path
    runs: Mapping[str, Run]

    def __getitem__(self, run: str) -> Recording:
        """Return a run.

        KeyError: there is no such run.
        InputError: its file is missing or damaged.
        """
        return Recording(self.runs[run], read_columns(self.folder / f"{run}.parquet"))

    def __contains__(self, run: object) -> bool:
        """Return whether there is such a run, without reading it."""
        return run in self.runs

    def __iter__(self) -> Iterator[str]:
        """Iterate over the ids, in the order of the dataset."""
        return iter(self.runs)

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.runs)


def write_dataset(folder: Path, manifest: Manifest, tables: Mapping[str, pa.Table]) -> None:
    """Write the runs' tables and the manifest with their checksums into an empty folder."""
    runs = []
    for run in manifest.run:
        path = folder / run.file
        path.parent.mkdir(exist_ok=True)
        write_parquet(path, tables[run.id])
        runs.append(run.model_copy(update={"sha256": sha256_of(path)}))
    write_manifest(folder, manifest.model_copy(update={"run": tuple(runs)}))


def write_runs(folder: Path, runs: Mapping[str, Recording]) -> None:
    """Write runs that belong to no dataset into a new folder, one file each, NaN as null."""
    folder.mkdir()
    for recording in runs.values():
        write_result(folder, recording)


def write_result(folder: Path, result: Recording) -> None:
    """Write a stage's result for a run, NaN as null, into the folder of its runs."""
    write_parquet(folder / f"{result.run.id}.parquet", table_of(result.columns))


def table_of(columns: Mapping[str, Floats]) -> pa.Table:
    """Return columns by name, shape (n,) each, as a table, NaN as null."""
    return pa.Table.from_arrays([column_of(v) for v in columns.values()], list(columns))


def write_parquet(path: Path, table: pa.Table) -> None:
    """Write a table of float64 columns; canonical ones get their unit as field metadata."""
    with parquet_writer(path, table.schema) as write:
        write(table)


@contextmanager
def parquet_writer(path: Path, schema: pa.Schema) -> Iterator[Callable[[pa.Table], None]]:
    """Yield a function that writes tables of one schema as row groups; see `write_parquet`."""
    fields = [
        field.with_metadata({"unit": BY_NAME[field.name].unit}) if field.name in BY_NAME else field
        for field in schema
    ]
    with_units = pa.schema(fields)
    with pq.ParquetWriter(
        path,
        with_units,
        compression="zstd",
        use_dictionary=False,
        use_byte_stream_split=[f.name for f in schema if pa.types.is_floating(f.type)],
    ) as writer:
        yield lambda table: writer.write_table(table.cast(with_units))


def result_file(folder: Path, run: str) -> Path:
    """Return the file of a stage's result for a run.

    InputError: the run's id leads out of the folder, or a link does.
    """
    path = folder / "runs" / f"{run}.parquet"
    try:
        check_run_name(run)
    except ValueError as error:
        raise InputError(f"run id {run[:80]!r} {error}", where=folder) from error
    if not is_inside(path, folder):
        raise InputError("a link leads out of its folder", where=path)
    return path


def names_of(path: Path) -> list[str]:
    """Return the names of the columns of such a file."""
    with reading(path), open_parquet(path) as file:
        return list(file.schema_arrow.names)


def columns_of(path: Path, names: Sequence[str]) -> dict[str, Floats]:
    """Return columns of such a file by name, shape (n,) each, null as NaN.

    InputError: the file cannot be read or lacks a column.
    """
    with reading(path), open_parquet(path) as file:
        check_size(file, path, names, whole=True)
        table = file.read(columns=list(names))
        missing = [name for name in names if name not in table.column_names]
        if missing:
            raise InputError(f"column {missing[0]} is missing", where=path)
        return {name: floats_from(table.column(name)) for name in names}


def check_rows(path: Path, found: int, rows: int, *, stage: str = "the stage") -> None:
    """Refuse a result whose number of samples differs from the recording's."""
    if found != rows:
        raise InputError(
            count_of(found, "row"),
            where=path,
            expected=f"{rows}, as the recording has",
            remedy=f"run {stage} again",
        )
