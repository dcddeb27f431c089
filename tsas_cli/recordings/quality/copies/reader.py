"""Runs in pieces, one or two side by side; short ones stay in memory, as they are read again."""

from collections.abc import Iterator, Sequence

import numpy as np

from tsas_cli.recordings.columns import TIME, largest
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece, known_columns, long_run, pieces
from tsas_cli.recordings.quality.copies.agreement import MARGIN_ROWS, RunSamples
from tsas_cli.recordings.quality.copies.fingerprint import Fingerprint, fingerprint
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.support.errors import InputError

CACHE_VALUES = 1 << 23  # of short runs that stay in memory


class Reader:
    """The pieces of each run; short runs are cached up to `CACHE_VALUES`."""

    def __init__(self, dataset: Dataset, *, strict: bool) -> None:
        """Open a dataset; without `strict`, implausible values become NaN."""
        self.dataset, self.strict = dataset, strict
        self.cache: dict[str, Piece] = {}
        self.room = CACHE_VALUES

    def parts(self, run: Run) -> Iterator[Piece]:
        """Yield the pieces of a run."""
        if run.id in self.cache:
            yield self.cache[run.id]
            return
        folder = self.dataset.folder
        long = long_run(folder, run)
        if long is not None:
            parts = pieces(long, known_columns(long), strict=self.strict)
            yield from parts if self.strict else map(_plausible, parts)
            return
        piece = Piece(0, dict(read_recording(folder, run, strict=self.strict).columns))
        piece = piece if self.strict else _plausible(piece)
        size = piece.rows * len(piece.columns)
        if size <= self.room:
            self.room -= size
            self.cache[run.id] = piece
        yield piece

    def fingerprint(self, run: Run) -> Fingerprint | None:
        """Return the fingerprint of a run; without `strict`, None if it cannot be read."""
        try:
            return fingerprint(run, self.parts(run))
        except InputError:
            if self.strict:
                raise
            return None


def _plausible(piece: Piece) -> Piece:
    """Return a piece with its implausible values as NaN."""
    return Piece(
        piece.start,
        {
            name: np.where(np.abs(values) <= largest(name), values, np.nan)
            for name, values in piece.columns.items()
        },
    )


MOST_SAMPLES = 1 << 16  # compared at once


def side_by_side(
    run: Iterator[Piece], source: Iterator[Piece], names: Sequence[str], shift_s: float
) -> Iterator[tuple[int, RunSamples, RunSamples]]:
    """Yield all samples of a run, moved by `shift_s` onto a source's clock, in order.

    Each part is consecutive samples, after the number of the first in its run, and before the
    source's samples around them. Run and source are given in pieces, at least one each; `names` are
    the common channels.
    """
    row, left = 0, RunSamples(np.empty(0), np.empty((0, len(names))))
    around = _samples(next(source), names)
    ahead = next(source, None)
    while True:
        if left.time_s.size == 0:
            part = next(run, None)
            if part is None:
                return
            row, left = part.start, _samples(part, names).moved(shift_s)
        # The last samples of a piece lack their margin until the next piece is read.
        until = np.inf if ahead is None else around.time_s[-MARGIN_ROWS]
        here = min(int(np.searchsorted(left.time_s, until)), MOST_SAMPLES)
        if here:
            now = left.part(slice(0, here))
            first, last = np.searchsorted(around.time_s, now.time_s[[0, -1]]).tolist()
            first = min(first, around.time_s.size - 2)  # the run may begin after the source's end
            near = around.part(slice(max(first - MARGIN_ROWS, 0), last + MARGIN_ROWS))
            yield row, now, near
            row, left = row + here, left.part(slice(here, None))
        elif ahead is not None:
            overlap = around.part(slice(-2 * MARGIN_ROWS, None))
            more = _samples(ahead, names)
            around = RunSamples(
                np.concatenate((overlap.time_s, more.time_s)),
                np.concatenate((overlap.values, more.values)),
            )
            ahead = next(source, None)


def _samples(piece: Piece, names: Sequence[str]) -> RunSamples:
    return RunSamples(piece.columns[TIME], np.column_stack([piece.columns[n] for n in names]))
