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

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.parquet_files import check_size, in_batches, reading
from tsas_cli.recordings.run_files import (
    RunColumns,
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
    check_size(opened.file, opened.path, opened.known, size=opened.size, whole=False)
    return opened


def pieces(
    run: RunColumns, names: Sequence[str], *, overlap: int = 0, strict: bool = True
) -> Iterator[Piece]:
    """Yield columns in pieces of `MOST_ROWS` rows; consecutive pieces share `overlap` rows.

    With `strict=False`, time may stop or decrease, and values may be implausible.

    InputError: the file cannot be read, a column is not numeric or holds an implausible value, or
    time does not increase.
    """
    batches = run.file.iter_batches(min(_BATCH_ROWS, MOST_ROWS), columns=list(names))
    start, last_s, began_s = 0, np.empty(0), None
    with reading(run.path):
        for table in in_batches(batches, MOST_ROWS, overlap=overlap):
            columns = {  # copies, as kernels compile anew for read-only arrays
                name: np.array(floats_of(table, name, run.path, first_row=start)) for name in names
            }
            for name, values in columns.items() if strict else ():
                check_magnitude(name, values, run.path, first_row=start)
            if strict and TIME in columns:
                time_s = np.concatenate((last_s, columns[TIME]))
                began_s = time_s[0] if began_s is None else began_s
                check_time(time_s, run.path, first_row=start - last_s.size, began_s=began_s)
                last_s = columns[TIME][MOST_ROWS - overlap - 1 : MOST_ROWS - overlap].copy()
            yield Piece(start, columns)
            start += table.num_rows - overlap
