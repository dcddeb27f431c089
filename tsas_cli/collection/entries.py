"""What one manifest or one diagnosis adds to the index."""

from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from glob import escape
from pathlib import Path

import duckdb
import pyarrow as pa
import pyarrow.parquet as pq
from duckdb import DuckDBPyConnection

from tsas_cli.collection.found import DIAGNOSIS, MANIFEST
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Rig, Run, parse, read_manifest
from tsas_cli.records.diagnosis import Diagnosis
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of

Entry = dict[str, object]  # by the names of `SCHEMA`, which checks it
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
SELECT file_name,
    min(TRY_CAST(stats_min_value AS DOUBLE)) FILTER (path_in_schema = $time),
    max(TRY_CAST(stats_max_value AS DOUBLE)) FILTER (path_in_schema = $time),
    count(*) FILTER (
        path_in_schema = $time
        AND TRY_CAST(stats_min_value AS DOUBLE) + TRY_CAST(stats_max_value AS DOUBLE) IS NULL
    )
FROM parquet_metadata($files) GROUP BY file_name
"""


def entry_of(connection: DuckDBPyConnection, folder: Path, file: str) -> Entry:
    """Return what a file says, by the names of the index; what is wrong stands in `problems`."""
    try:
        return _KINDS[file](connection, folder)
    except InputError as error:
        return {"problems": [_without_place(error)]}
    except OSError as error:
        return {"problems": [f"cannot be read ({error.strerror})"]}
    except (ValueError, OverflowError) as error:  # a time or a number that is valid, but no text
        return {"problems": [f"holds a value that cannot be told ({limits.reason(error)})"]}


def _manifest(connection: DuckDBPyConnection, folder: Path) -> Entry:
    manifest = read_manifest(folder)
    problems: list[str] = []
    paths = [folder / run.file for run in manifest.run]
    readable = [path for path in paths if path.exists() and _refusal(folder, path) is None]
    durations = _durations_s(connection, readable)
    return {
        "sha256": sha256_of(folder / MANIFEST),
        "dataset": manifest.name,
        "kind": manifest.kind,
        "rig": {name: getattr(manifest.rig, name) for name in RIG},
        "runs": [_run(folder, run, durations, problems) for run in manifest.run],
        "problems": problems,
    }


def _run(
    folder: Path, run: Run, durations: Mapping[Path, float | None], problems: list[str]
) -> Entry:
    said: Entry = {
        "run": run.id,
        "started": None if run.started is None else _utc(run.started),
        "load": run.load,
        "total_bend_rad": run.total_bend_rad,
        "sheath_length_mm": run.sheath_length_mm,
        "preload_N": run.preload_N,
        "tags": {key: str(value) for key, value in (run.model_extra or {}).items()},
    }
    try:
        return said | _footer(folder, run, durations)
    except (pa.ArrowException, OSError) as error:
        problems.append(f"{run.file}: {str(error).splitlines()[0]}")
        return said


def _footer(folder: Path, run: Run, durations: Mapping[Path, float | None]) -> Entry:
    """Return what the end of a run's Parquet file says of it; no sample is read."""
    path = folder / run.file
    refusal = _refusal(folder, path)
    if refusal is not None:
        raise OSError(refusal)
    footer = pq.read_metadata(path)
    names = footer.schema.names
    if path not in durations and footer.num_row_groups:
        raise OSError("its footer is damaged")
    duration = durations.get(path)
    return {
        "rows": footer.num_rows,
        "duration_s": duration,
        "rate_Hz": (footer.num_rows - 1) / duration if duration else None,
        "channels": [name for name in names if name != TIME],
        "bytes": path.stat().st_size,
    }


def _refusal(folder: Path, path: Path) -> str | None:
    """Return why a run's file is not read, whether it exists or not; None where it may be."""
    if not path.resolve().is_relative_to(folder.resolve()):
        return "a link leads out of the dataset's folder"
    if path.exists() and not path.is_file():
        return "is no file"  # a pipe would be waited for
    return None


def _durations_s(connection: DuckDBPyConnection, paths: Sequence[Path]) -> dict[Path, float | None]:
    """Return the time from first to last sample [s] of files, None where one does not say it.

    What is damaged is left out. To ask for many takes hardly longer than to ask for one.
    """
    if not paths:
        return {}
    files = [escape(str(path)) for path in paths]
    try:
        told = connection.execute(TIMES, {"files": files, "time": TIME}).fetchall()
    except duckdb.Error:
        if len(paths) == 1:
            return {}
        each = [_durations_s(connection, [path]) for path in paths]
        return {path: duration for one in each for path, duration in one.items()}
    return {
        Path(name): None if first is None or silent else float(last) - float(first)
        for name, first, last, silent in told
    }


def _diagnosis(_: DuckDBPyConnection, folder: Path) -> Entry:
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


_KINDS: Mapping[str, Callable[[DuckDBPyConnection, Path], Entry]] = {
    MANIFEST: _manifest,
    DIAGNOSIS: _diagnosis,
}


def _utc(at: datetime) -> datetime:
    """Return a time without its zone: that of UTC where it has one, else as it was written."""
    return at if at.tzinfo is None else at.astimezone(UTC).replace(tzinfo=None)


def _without_place(error: InputError) -> str:
    return InputError(error.what, expected=error.expected, remedy=error.remedy).line()
