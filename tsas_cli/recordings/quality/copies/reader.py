"""Runs in pieces; short runs stay in memory, since the search reads them several times."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece, known_columns, long_run, pieces
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
