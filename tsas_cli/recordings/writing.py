"""Writing of runs and datasets."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.arrow_columns import column_of
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Manifest, Run, write_manifest
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.arrays import Floats
from tsas_cli.support.files import sha256_of


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
