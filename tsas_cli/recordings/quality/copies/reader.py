"""Every run in pieces, short ones from memory, as a search reads them several times."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece, known_columns, long_run, pieces
from tsas_cli.recordings.quality.copies.fingerprint import Fingerprint, fingerprint
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.support.errors import InputError

KEPT = 1 << 23  # values of short runs that stay in memory


class Reader:
    """The pieces of each run; those of short runs stay in memory, as long as they are not many."""

    def __init__(self, dataset: Dataset, *, strict: bool) -> None:
        """Take the runs; what no rig has is left out of them where that is not `strict`."""
        self.dataset, self.strict = dataset, strict
        self.kept: dict[str, Piece] = {}
        self.room = KEPT

    def parts(self, run: Run) -> Iterator[Piece]:
        """Read a run, piece by piece."""
        if run.id in self.kept:
            yield self.kept[run.id]
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
            self.kept[run.id] = piece
        yield piece

    def fingerprint(self, run: Run) -> Fingerprint | None:
        """Return what a run is recognised by; None where it cannot be read and need not be."""
        try:
            return fingerprint(run, self.parts(run))
        except InputError:
            if self.strict:
                raise
            return None


def _plausible(piece: Piece) -> Piece:
    """Return a piece without the values that no rig has."""
    return Piece(
        piece.start,
        {
            name: np.where(np.abs(values) <= largest(name), values, np.nan)
            for name, values in piece.columns.items()
        },
    )
