"""Recordings that are too long for memory, read in pieces of `MOST_ROWS` rows.

A stage keeps one piece and its results so far, never a column, so that its memory does not grow
with the recording.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.parquet_files import check_size, reading
from tsas_cli.recordings.run_files import (
    RunColumns,
    check_columns,
    check_magnitude,
    check_time,
    floats_of,
    open_run,
)
from tsas_cli.recordings.storage import Location
from tsas_cli.support.arrays import Floats

MOST_ROWS = 1 << 20  # of a recording that is read whole, and of a piece of a longer one
_BATCH_ROWS = 1 << 16


@dataclass(frozen=True)
class Piece:
    """Columns by name, shape (n,), of n rows from row `start` on; null is NaN."""

    start: int
    columns: dict[str, Floats]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next(iter(self.columns.values())).size

    @property
    def stop(self) -> int:
        """The row after the last one."""
        return self.start + self.rows


def long_run(folder: Location, run: Run) -> RunColumns | None:
    """Return an open run of more than `MOST_ROWS` rows; None if it has fewer, or is no Parquet.

    InputError: its file, columns or units violate the manifest or format 1.
    """
    if isinstance(folder, Path):
        path = folder / run.file
        try:
            if not path.is_file() or pq.read_metadata(path).num_rows <= MOST_ROWS:
                return None
        except (pa.ArrowException, OSError):  # the reader of a short run reports it
            return None
    opened = open_run(folder, run)
    if opened.rows <= MOST_ROWS:
        return None
    known = known_columns(opened)
    check_columns(known, opened.file.schema_arrow.names, opened.path)
    check_size(opened.file, opened.path, known, size=opened.size, whole=False)
    return opened


def known_columns(run: RunColumns) -> list[str]:
    """Return the names of the canonical columns of a run, in the order of the file."""
    return [name for name in run.file.schema_arrow.names if name in BY_NAME]


def pieces(
    run: RunColumns, names: Sequence[str], *, overlap: int = 0, strict: bool = True
) -> Iterator[Piece]:
    """Yield columns in pieces of `MOST_ROWS` rows; consecutive pieces share `overlap` rows.

    With `strict=False`, time may stop or decrease, and values may be implausible.

    InputError: the file cannot be read, a column is not numeric or holds an implausible value, or
    time does not increase.
    """
    buffered: dict[str, list[Floats]] = {name: [] for name in names}
    start = count = read = 0
    last_s: Floats = np.empty(0)
    with reading(run.path):
        for batch in run.file.iter_batches(min(_BATCH_ROWS, MOST_ROWS), columns=list(names)):
            table = pa.Table.from_batches([batch])
            for name in names:
                buffered[name].append(floats_of(table, name, run.path, first_row=read))
                if strict:
                    check_magnitude(name, buffered[name][-1], run.path, first_row=read)
            if strict and TIME in names:
                time_s = np.concatenate((last_s, buffered[TIME][-1]))
                check_time(time_s, run.path, first_row=read - last_s.size)
                last_s = time_s[-1:]
            read += batch.num_rows
            count += batch.num_rows
            while count >= MOST_ROWS:
                joined = {name: np.concatenate(buffered[name]) for name in names}
                yield Piece(start, {name: v[:MOST_ROWS] for name, v in joined.items()})
                buffered = {name: [v[MOST_ROWS - overlap :].copy()] for name, v in joined.items()}
                start, count = start + MOST_ROWS - overlap, count - MOST_ROWS + overlap
    if count > overlap or start == 0:
        yield Piece(start, {name: np.concatenate(buffered[name]) for name in names})
