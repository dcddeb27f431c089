"""Runs and datasets on their way to disk."""

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.files import sha256_of
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Manifest, Run, write_manifest
from tsas_cli.recordings.recording import Recording


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
        write_answer(folder, recording)


def write_answer(folder: Path, answer: Recording) -> None:
    """Write what a stage says about a run, NaN as null, into the folder of its runs."""
    write_parquet(folder / f"{answer.run.id}.parquet", table_of(answer))


def table_of(recording: Recording) -> pa.Table:
    """Return a run's columns as a table, NaN as null."""
    columns = {name: pa.array(v, from_pandas=True) for name, v in recording.columns.items()}
    return pa.table(columns)


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
