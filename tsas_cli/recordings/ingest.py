"""Ingest: raw files to a dataset."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fnmatch import fnmatch
from itertools import chain
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.canonical import canonical_columns
from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.dataset import read_from
from tsas_cli.recordings.ingest_map import IngestMap, run_conditions
from tsas_cli.recordings.manifest import Manifest, Run, write_manifest
from tsas_cli.recordings.readers import READABLE, batches, is_known
from tsas_cli.recordings.readers.joined import joined_by
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, whole
from tsas_cli.recordings.units import conversion
from tsas_cli.recordings.validation import parse
from tsas_cli.recordings.writing import parquet_writer, table_of
from tsas_cli.support import __version__, limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import check_unchanged, sha256_of, state_of
from tsas_cli.support.steps import NO_PROGRESS, Steps

How = Literal["first", "last", "mean"]


@dataclass(frozen=True)
class Ingested:
    """One ingested file: its run, size and columns, and which units of the map are not its own."""

    run: str
    source: Path
    rows: int
    duration_s: float
    rate_Hz: float
    columns: tuple[str, ...]
    notes: tuple[str, ...] = ()


def find_files(sources: Sequence[Path], pattern: str) -> list[Path]:
    """Return the source files, and those below the source folders that fit a pattern ("*.csv").

    InputError: a source does not exist, or a folder holds no such file.
    """
    found: list[Path] = []
    for source in sources:
        files = _files_in(source, pattern) if source.is_dir() else [source]
        if not source.exists() or not files:
            raise InputError(
                "holds no file to ingest" if source.is_dir() else "does not exist",
                where=source,
                expected=READABLE if source.is_dir() else "a recording, or a folder of them",
                remedy=_nearest(source),
            )
        found += files
    if len(found) > limits.RUNS:
        raise InputError(
            f"{len(found)} files found",
            where=sources[0],
            expected=f"at most {limits.RUNS} for one dataset",
            remedy="ingest fewer folders at a time, or set files under [read] of the map",
        )
    return found


def _nearest(source: Path) -> str:
    """Return the name beside a file that is not there, if one is like it."""
    beside = [] if source.exists() else [path.name for path in source.parent.glob("*")]
    close = get_close_matches(source.name, beside, n=1)
    return f"did you mean {close[0]}?" if close else ""


def ingest_files(
    files: Sequence[Path],
    mapping: IngestMap,
    map_path: Path,
    folder: Path,
    *,
    step: Steps = NO_PROGRESS,
) -> list[Ingested]:
    """Write the files as the runs of a dataset into an empty folder.

    `step` is called twice per file: when it is opened and when its run is written. Text tables and
    Parquet are read, converted and written in parts.

    InputError: a file does not match the map, or two files have the same run id.
    """
    runs: list[Run] = []
    ingested: dict[str, Ingested] = {}
    step.ahead(2 * len(files))
    states = {path: state_of(path) for path in files}
    time = mapping.columns[TIME]
    for path in files:
        parts = batches(path, mapping.read, mapping.sources())
        if (how := mapping.read.repeated_times) and time.rate_Hz is None:
            parts = merged(parts, time.source, how)
        first = next(parts)
        step()
        conditions = run_conditions(path, first.header, mapping.run, mapping.read.decimal)
        # The checksum is known once the file is written.
        entry = {"file": f"runs/{conditions['id']}.parquet", "sha256": "0" * 64}
        run = parse(Run, conditions | entry, path)
        if run.id in ingested:
            raise InputError(
                f"run id {run.id!r} is also that of {ingested[run.id].source}",
                where=path,
                expected="a distinct id for each file",
                remedy='set a distinct id in the map: id = "{folder}_{stem}" under [run]',
            )
        written = folder / run.file
        written.parent.mkdir(exist_ok=True)
        notes = tuple(_other_units(first, mapping))
        made = _ingest(chain((first,), parts), run.id, path, mapping, map_path, written)
        ingested[run.id] = replace(made, notes=notes)
        runs.append(run.model_copy(update={"sha256": sha256_of(written)}))
        step()
    content = {
        "format": 1,
        **mapping.dataset.model_dump(exclude_none=True),
        "rig": mapping.rig,
        "run": runs,
        "ingest": {
            "version": __version__,
            "map": read_from(map_path, folder),
            "sources": {one.run: read_from(one.source, folder) for one in ingested.values()},
        },
    }
    for path, state in states.items():
        check_unchanged(path, state)
    write_manifest(folder, parse(Manifest, content, map_path))
    return list(ingested.values())


def _other_units(table: ColumnTable, mapping: IngestMap) -> Iterator[str]:
    """Yield a sentence for each column whose unit in the map is another one than in the file."""
    for name, column in mapping.columns.items():
        stated, to = table.units.get(column.source, ""), BY_NAME[name].unit
        if not column.unit or not stated or column.rate_Hz or column.factor is not None:
            continue
        sizes = []
        for unit in (stated, column.unit):
            with suppress(InputError):  # of the map's it is an error, which conversion raises
                sizes.append(conversion(unit, to, pulley_radius_mm=column.pulley_radius_mm))
        if len(sizes) < 2 or not np.allclose(sizes[0], sizes[1], rtol=1e-9, atol=0.0):
            yield (
                f"{column.source} is in {stated} by the file and in {column.unit} by the map, "
                "which counts."
            )


def _files_in(folder: Path, pattern: str) -> list[Path]:
    """Return the recordings in a folder, those that a list joins to one as that list alone."""
    files = sorted(
        path
        for path in folder.rglob("*")
        if is_known(path)
        and fnmatch(path.name, pattern)
        and not path.name.startswith(".")
        and path.is_file()
    )
    joined = {part for path in files for part in joined_by(path)}
    return [path for path in files if path not in joined]


def _ingest(
    parts: Iterator[ColumnTable],
    run: str,
    path: Path,
    mapping: IngestMap,
    map_path: Path,
    written: Path,
) -> Ingested:
    """Write one file part by part; return its summary."""
    columns, before = canonical_columns(next(parts), mapping, path, map_path)
    first_s = float(columns[TIME][0])
    table = table_of(columns)
    with parquet_writer(written, table.schema) as write:
        write(table)
        for part in parts:
            columns, before = canonical_columns(part, mapping, path, map_path, before)
            if columns[TIME].size:
                write(table_of(columns))
    rows, duration_s = before.kept, before.last[TIME] - first_s
    if rows < 2:
        raise InputError("all rows are identical", where=path, expected="at least two samples")
    return Ingested(run, path, rows, duration_s, (rows - 1) / duration_s, tuple(columns))


def merged(parts: Iterable[ColumnTable], time: ColumnSource, how: How) -> Iterator[ColumnTable]:
    """Yield the parts of a file with one row for each time, which may be repeated across parts.

    `time` is the source of the clock; rows of one time follow each other. `how` says which row
    stays, or the mean of each column, gaps left out.
    """
    held: ColumnTable | None = None  # the rows of the last time
    for part in parts:
        table = whole([held, part] if held else [part])
        begins = np.flatnonzero(np.diff(table.columns[time], prepend=np.nan) != 0.0)
        if begins.size > 1:
            yield _one_each(_rows(table, slice(0, int(begins[-1]))), begins[:-1], how)
        held = _rows(table, slice(int(begins[-1]) if begins.size else 0, None))
    if held is not None:
        yield _one_each(held, np.zeros(1, dtype=np.intp), how)


def _rows(table: ColumnTable, rows: slice) -> ColumnTable:
    columns = {source: values[rows] for source, values in table.columns.items()}
    return replace(table, columns=columns, numbers=table.row_numbers[rows])


def _one_each(table: ColumnTable, begins: npt.NDArray[np.intp], how: How) -> ColumnTable:
    rows = table.row_numbers.size
    if not rows:
        return table
    chosen = begins if how != "last" else np.append(begins[1:], rows) - 1
    columns = {source: values[chosen] for source, values in table.columns.items()}
    for source, values in table.columns.items() if how == "mean" else ():
        finite = np.isfinite(values)
        counts = np.add.reduceat(finite.astype(np.float64), begins)
        sums = np.add.reduceat(np.where(finite, values, 0.0), begins)
        gaps = np.full(counts.size, np.nan)
        columns[source] = np.divide(sums, counts, out=gaps, where=counts > 0)
    return replace(table, columns=columns, numbers=table.row_numbers[chosen])
