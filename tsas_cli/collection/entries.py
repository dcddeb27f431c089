"""The entry of one manifest or one diagnosis in the index."""

import os
import stat
from collections.abc import Mapping, Sequence
from datetime import UTC
from glob import escape
from pathlib import Path
from typing import NamedTuple

import duckdb
import pyarrow as pa
import pyarrow.parquet as pq
from duckdb import DuckDBPyConnection

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import RigSheet, Run, read_manifest
from tsas_cli.recordings.storage import is_inside
from tsas_cli.recordings.validation import parse
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of
from tsas_cli.support.limits import is_text

MANIFEST, DIAGNOSIS = "dataset.toml", "diagnosis.json"
_MOST = 2**63 - 1  # of an integer in the index; as a time, the year 2262
Entry = dict[str, object]  # by the names of `SCHEMA`, which checks it
RIG = tuple(RigSheet.model_fields)
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
# pyarrow provides these numbers too, but ends the process if the footer is damaged.
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


class FileKey(NamedTuple):
    """Location of a file: number of the root folder, folder relative to it, and name."""

    root: int
    folder: str
    file: str


class Stamp(NamedTuple):
    """Evidence of a change of a file: time of its last modification [ns] and size [bytes]."""

    mtime_ns: int
    size: int


def entry_of(connection: DuckDBPyConnection, folder: Path, file: str) -> Entry:
    """Return the entry of a file by the columns of the index, with its faults in `problems`."""
    try:
        return _manifest(connection, folder) if file == MANIFEST else _diagnosis(folder)
    except InputError as error:
        error.where = ""  # the index knows the file
        return {"problems": [error.line()]}
    except OSError as error:
        return {"problems": [f"cannot be read ({error.strerror})"]}
    except (ValueError, OverflowError) as error:  # a time or number beyond what can be held
        return {"problems": [f"holds a value that cannot be represented ({limits.reason(error)})"]}


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
    started = run.started
    if started is not None and started.tzinfo is not None:
        started = started.astimezone(UTC).replace(tzinfo=None)
    entry: Entry = {
        **run.model_dump(include={"load", *CONDITIONS}),
        "run": run.id,
        "started": started,  # in UTC, without a zone, if it has one
        "tags": {key: str(value) for key, value in (run.model_extra or {}).items()},
    }
    try:
        return entry | _footer(folder, run, durations)
    except (pa.ArrowException, OSError) as error:
        problems.append(f"{run.file}: {str(error).splitlines()[0]}")
        return entry


def _footer(folder: Path, run: Run, durations: Mapping[Path, float | None]) -> Entry:
    """Return the properties of a run in the footer of its Parquet file; no sample is read."""
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
    """Return the reason not to read a run's file; None if it may be read or does not exist."""
    if not is_inside(path, folder):
        return "a link leads out of the dataset's folder"
    if path.exists() and not path.is_file():
        return "is no regular file"  # reading a pipe would block
    return None


def _durations_s(connection: DuckDBPyConnection, paths: Sequence[Path]) -> dict[Path, float | None]:
    """Return the duration of files [s], None for a file without statistics of its time.

    Damaged files are left out. A query for many takes hardly longer than for one.
    """
    if not paths:
        return {}
    files = [escape(str(path)) for path in paths]
    try:
        rows = connection.execute(TIMES, {"files": files, "time": TIME}).fetchall()
    except duckdb.Error:
        if len(paths) == 1:
            return {}
        each = [_durations_s(connection, [path]) for path in paths]
        return {path: duration for one in each for path, duration in one.items()}
    return {
        Path(name): None if first is None or incomplete else float(last) - float(first)
        for name, first, last, incomplete in rows
    }


def _diagnosis(folder: Path) -> Entry:
    path = folder / DIAGNOSIS
    diagnosis = parse(DiagnosisFile, read_json(path), path)
    chosen = diagnosis.chosen if diagnosis.chosen is not None else diagnosis.dataset.chosen
    return {
        "manifest_sha256": diagnosis.dataset.hashes.get(MANIFEST, "").lower(),
        "chosen": None if chosen is None else list(chosen),
        "verdict": diagnosis.verdict,
        "causes": [cause.effect for cause in diagnosis.named],
        "problems": [],
    }


def files_below(roots: Sequence[Path]) -> tuple[dict[FileKey, Stamp], list[str]]:
    """Return the manifests and diagnoses below folders, and the folders that cannot be read.

    Hidden folders, links to folders and the `runs` of a dataset are skipped.
    """
    found: dict[FileKey, Stamp] = {}
    problems: list[str] = []

    def unreadable(error: OSError) -> None:
        problems.append(f"{error.filename}: cannot be read ({error.strerror})")

    for number, root in enumerate(roots):
        if not is_text(root):
            problems.append(f"{root}: its name is not UTF-8; rename it")
            continue
        for place, folders, files in os.walk(root, onerror=unreadable):
            folder = place[len(str(root)) :].strip("/")
            for name in {MANIFEST, DIAGNOSIS}.intersection(files):
                try:
                    state = os.stat(f"{place}/{name}")  # noqa: PTH116 - Path is slower
                except FileNotFoundError:  # a link to nothing
                    continue
                except OSError as error:
                    unreadable(error)
                    continue
                if stat.S_ISREG(state.st_mode):
                    changed_ns = max(-_MOST, min(state.st_mtime_ns, _MOST))
                    found[FileKey(number, folder, name)] = Stamp(changed_ns, state.st_size)
            shown = [name for name in folders if not name.startswith(".")]
            problems += [
                f"{place}/{name}: a name with control characters"
                for name in shown
                if not name.isprintable()
            ]
            skipped = "runs" if FileKey(number, folder, MANIFEST) in found else ""
            folders[:] = [name for name in shown if name.isprintable() and name != skipped]
    return found, problems
