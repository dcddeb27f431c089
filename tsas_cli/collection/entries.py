"""What one manifest or one diagnosis adds to the index."""

from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from glob import escape
from pathlib import Path
from typing import Any

import duckdb
import pyarrow as pa
import pyarrow.parquet as pq
from duckdb import DuckDBPyConnection

from tsas_cli.collection.found import DIAGNOSIS, MANIFEST
from tsas_cli.errors import InputError
from tsas_cli.files import read_json, sha256_of
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Rig, Run, parse, read_manifest
from tsas_cli.stage_files.diagnosis import Diagnosis

RIG = tuple(Rig.model_fields)
TEXTS = pa.list_(pa.string())
RUN = pa.struct(
    {
        "run": pa.string(),
        "started": pa.timestamp("us"),
        "load": pa.string(),
        "total_bend_rad": pa.float64(),
        "sheath_length_mm": pa.float64(),
        "preload_N": pa.float64(),
        "rows": pa.int64(),
        "duration_s": pa.float64(),
        "rate_Hz": pa.float64(),
        "channels": TEXTS,
        "bytes": pa.int64(),
        "tags": pa.map_(pa.string(), pa.string()),
    }
)
SCHEMA = pa.schema(
    {
        "root": pa.int32(),
        "folder": pa.string(),
        "file": pa.string(),
        "mtime_ns": pa.int64(),
        "size": pa.int64(),
        "problems": TEXTS,
        # of a manifest
        "sha256": pa.string(),
        "dataset": pa.string(),
        "kind": pa.string(),
        "rig": pa.struct(dict.fromkeys(RIG, pa.float64())),
        "runs": pa.list_(RUN),
        # of a diagnosis
        "manifest_sha256": pa.string(),
        "chosen": TEXTS,
        "verdict": pa.string(),
        "causes": TEXTS,
    }
)

# pyarrow knows these numbers too, but ends the process where the footer is damaged.
TIMES = """
SELECT min(TRY_CAST(stats_min_value AS DOUBLE)), max(TRY_CAST(stats_max_value AS DOUBLE)),
    count(*) - count(TRY_CAST(stats_min_value AS DOUBLE) + TRY_CAST(stats_max_value AS DOUBLE))
FROM parquet_metadata(?) WHERE path_in_schema = ?
"""


def entry_of(connection: DuckDBPyConnection, folder: Path, file: str) -> dict[str, Any]:
    """Return what a file says, by the names of the index; what is wrong stands in `problems`."""
    try:
        return _KINDS[file](connection, folder)
    except InputError as error:
        return {"problems": [_without_place(error)]}
    except OSError as error:
        return {"problems": [f"cannot be read ({error.strerror})"]}


def _manifest(connection: DuckDBPyConnection, folder: Path) -> dict[str, Any]:
    manifest = read_manifest(folder)
    problems: list[str] = []
    return {
        "sha256": sha256_of(folder / MANIFEST),
        "dataset": manifest.name,
        "kind": manifest.kind,
        "rig": {name: getattr(manifest.rig, name) for name in RIG},
        "runs": [_run(connection, folder, run, problems) for run in manifest.run],
        "problems": problems,
    }


def _run(
    connection: DuckDBPyConnection, folder: Path, run: Run, problems: list[str]
) -> dict[str, Any]:
    said = {
        "run": run.id,
        "started": None if run.started is None else _utc(run.started),
        "load": run.load,
        "total_bend_rad": run.total_bend_rad,
        "sheath_length_mm": run.sheath_length_mm,
        "preload_N": run.preload_N,
        "tags": {key: str(value) for key, value in (run.model_extra or {}).items()},
    }
    try:
        return said | _footer(connection, folder, run)
    except (pa.ArrowException, duckdb.Error, OSError) as error:
        problems.append(f"{run.file}: {str(error).splitlines()[0]}")
        return said


def _footer(connection: DuckDBPyConnection, folder: Path, run: Run) -> dict[str, Any]:
    """Return what the end of a run's Parquet file says of it; no sample is read."""
    path = folder / run.file
    if not path.resolve().is_relative_to(folder.resolve()):
        raise OSError("a link leads out of the dataset's folder")
    if path.exists() and not path.is_file():
        raise OSError("is no file")  # a pipe would be waited for
    footer = pq.read_metadata(path)
    names = footer.schema.names
    duration = _duration_s(connection, path)
    return {
        "rows": footer.num_rows,
        "duration_s": duration,
        "rate_Hz": (footer.num_rows - 1) / duration if duration else None,
        "channels": [name for name in names if name != TIME],
        "bytes": path.stat().st_size,
    }


def _duration_s(connection: DuckDBPyConnection, path: Path) -> float | None:
    """Return the time from the first to the last sample [s], None where the file doesn't say."""
    ((first, last, silent),) = connection.execute(TIMES, [escape(str(path)), TIME]).fetchall()
    return None if first is None or silent else float(last) - float(first)


def _diagnosis(_: DuckDBPyConnection, folder: Path) -> dict[str, Any]:
    path = folder / DIAGNOSIS
    content = read_json(path)
    said = parse(Diagnosis, content, path)
    chosen = said.chosen if said.chosen is not None else said.dataset.chosen
    return {
        "manifest_sha256": said.dataset.hashes.get(MANIFEST, "").lower(),
        "chosen": None if chosen is None else list(chosen),
        "verdict": said.verdict,
        "causes": [cause.effect for cause in said.named],
        "problems": [],
    }


_KINDS: Mapping[str, Callable[[DuckDBPyConnection, Path], dict[str, Any]]] = {
    MANIFEST: _manifest,
    DIAGNOSIS: _diagnosis,
}


def _utc(at: datetime) -> datetime:
    """Return a time without its zone: that of UTC where it has one, else as it was written."""
    return at if at.tzinfo is None else at.astimezone(UTC).replace(tzinfo=None)


def _without_place(error: InputError) -> str:
    return InputError(error.what, expected=error.expected, remedy=error.remedy).line()
