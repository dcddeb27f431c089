"""From a person's files to a dataset."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import pyarrow as pa

from tsas_cli import __version__, limits
from tsas_cli.errors import InputError
from tsas_cli.files import check_unchanged, sha256_of, state_of
from tsas_cli.recordings.canonical import canonical_columns
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.conditions import run_conditions
from tsas_cli.recordings.ingest_map import IngestMap
from tsas_cli.recordings.manifest import Manifest, Run, parse, write_manifest
from tsas_cli.recordings.readers import SUFFIXES, read
from tsas_cli.recordings.readers.table import Floats, Table
from tsas_cli.recordings.writing import write_run
from tsas_cli.steps import SILENT, Steps


@dataclass(frozen=True)
class Ingested:
    """What became of one file."""

    run: str
    source: Path
    rows: int
    duration_s: float
    rate_Hz: float
    columns: tuple[str, ...]


def find_files(sources: Sequence[Path], pattern: str) -> list[Path]:
    """Return the files among the sources, and those in the folders that a reader knows.

    Parameters
    ----------
    pattern
        What the names of a folder's files match ("*.csv").

    Raises
    ------
    InputError
        A source is not there, or a folder holds no such file.
    """
    found: list[Path] = []
    for source in sources:
        files = _files_in(source, pattern) if source.is_dir() else [source]
        if not source.exists() or not files:
            raise InputError(
                "holds no file to ingest" if source.is_dir() else "is not there",
                where=source,
                expected=f"a file, or a folder of files in {', '.join(SUFFIXES)}",
            )
        found += files
    if len(found) > limits.RUNS:
        raise InputError(
            f"{len(found)} files are found",
            where=sources[0],
            expected=f"at most {limits.RUNS} for one dataset",
            remedy="take fewer folders at a time, or say which: files under [read] of the map",
        )
    return found


def ingest_files(
    files: Sequence[Path],
    mapping: IngestMap,
    map_path: Path,
    folder: Path,
    *,
    step: Steps = SILENT,
) -> list[Ingested]:
    """Write the files as the runs of a dataset into an empty folder.

    `step` follows each piece of work: a file is read, brought to units, written.

    Raises
    ------
    InputError
        A file does not hold what the map says, or two files give one run id.
    """
    runs: list[Run] = []
    ingested: dict[str, Ingested] = {}
    step.ahead(3 * len(files))
    states = {path: state_of(path) for path in files}
    for path in files:
        table = read(path, mapping.read, mapping.sources())
        step()
        run = _run(path, table, mapping)
        if run.id in ingested:
            raise InputError(
                f"run id {run.id!r} comes from {ingested[run.id].source} too",
                where=path,
                expected="an id for each file",
                remedy='tell them apart in the map: id = "{folder}_{stem}" under [run]',
            )
        columns = canonical_columns(table, mapping, path, map_path)
        step()
        runs.append(write_run(folder, run, _with_nulls(columns)))
        ingested[run.id] = _summary(run.id, path, columns)
        step()
    content = {
        "format": 1,
        **mapping.dataset.model_dump(exclude_none=True),
        "rig": mapping.rig,
        "run": runs,
        "ingest": _origin(list(ingested.values()), map_path),
    }
    for path, state in states.items():
        check_unchanged(path, state)
    write_manifest(folder, parse(Manifest, content, map_path))
    return list(ingested.values())


def _files_in(folder: Path, pattern: str) -> list[Path]:
    return sorted(
        path
        for path in folder.rglob("*")
        if path.suffix.lower() in SUFFIXES
        and fnmatch(path.name, pattern)
        and not path.name.startswith(".")
        and path.is_file()
    )


def _run(path: Path, table: Table, mapping: IngestMap) -> Run:
    conditions = run_conditions(path, table.header, mapping.run)
    written = {
        "file": f"runs/{conditions['id']}.parquet",
        "sha256": "0" * 64,  # known once the file is written
    }
    return parse(Run, conditions | written, path)


def _origin(ingested: Sequence[Ingested], map_path: Path) -> dict[str, Any]:
    """Return what was read, with checksums."""
    return {
        "version": __version__,
        "map": _named(map_path),
        "sources": {one.run: _named(one.source) for one in ingested},
    }


def _named(path: Path) -> dict[str, str]:
    return {"file": path.name, "sha256": sha256_of(path)}


def _with_nulls(columns: dict[str, Floats]) -> pa.Table:
    return pa.table({n: pa.array(values, from_pandas=True) for n, values in columns.items()})


def _summary(run: str, path: Path, columns: dict[str, Floats]) -> Ingested:
    time_s = columns[TIME]
    duration = float(time_s[-1] - time_s[0])
    return Ingested(run, path, time_s.size, duration, (time_s.size - 1) / duration, tuple(columns))
