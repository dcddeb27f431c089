"""The rows of a run: the resolution of its channels, and a hash of each row's values."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece, long_run, pieces
from tsas_cli.recordings.quality.samples import alternates, calm_noise, step_of
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.support.arrays import Floats, Indices

WITHOUT_EVIDENCE = (TIME, "f_out_ref_N", "temperature_C")  # columns that identify no run
SAMPLE = 1 << 16  # rows from which the resolution is estimated
SINGLE_PRECISION = 2e-7  # of the largest value, rounding of single precision
NOISE_SHARE = 1 / 4  # of the noise, to which values without a step are rounded
NOISY = 1.25  # nats of a change: with noise as large as the step a repeat has it at 28 %
QUIET = 0.03  # nats without visible noise: at 97 %
MOST_PER_ROW = 2.5  # nats: noise may be correlated
MOST_ROWS = 1 << 20  # of a dataset that are compared; of more, a share by their hashes
CACHE_VALUES = 1 << 23  # of short runs that stay in memory
_FACTOR, _HALF = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)

Grid = tuple[tuple[str, float], ...]  # channels, and what their values are rounded to


@dataclass(frozen=True)
class RowSpan:
    """Consecutive rows of a run, `end` excluded, and the times of the first and last [s]."""

    first: int
    end: int
    begin_s: float
    end_s: float

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.end - self.first

    @property
    def duration_s(self) -> float:
        """Duration [s]."""
        return self.end_s - self.begin_s


class Resolution(NamedTuple):
    """Quantisation step of a channel, 0 without, and its noise, 0 if computed or below the step.

    The noise is rounded down to a power of two, so that runs of one sensor have the same.
    """

    step: float
    noise: float


@dataclass(frozen=True, eq=False)
class SearchedRun:
    """A run: its number in the dataset, its rows, and the resolution of channels that vary."""

    run: Run
    number: int
    all: RowSpan
    interval_s: float
    increases: bool  # the time
    channels: Mapping[str, Resolution]


@dataclass(frozen=True, eq=False)
class HashedRows:
    """Time [s], number, hash and information [nats] of rows of a run, all of shape (n,).

    The information is −ln of the probability that a repeat of the motion has the same hash; `noisy`
    says whether that is due to noise. `first` are the indices of each hash's first row, in the
    order of the hashes.
    """

    time_s: Floats
    row: Indices
    hashes: npt.NDArray[np.uint64]
    nats: Floats
    noisy: bool
    first: Indices

    def span(self, ends: Indices, whole: RowSpan) -> RowSpan:
        """Return the rows from one index to another, to the run's end where none is between."""
        first, last = ends.tolist()
        rows, times_s = self.row[ends].tolist(), self.time_s[ends].tolist()
        span = RowSpan(rows[0], rows[1] + 1, *times_s)
        if first == 0:
            span = replace(span, first=whole.first, begin_s=whole.begin_s)
        if last == self.row.size - 1:
            span = replace(span, end=whole.end, end_s=whole.end_s)
        return span


class Reader:
    """The runs of a dataset: their pieces, resolutions and hashed rows."""

    def __init__(self, dataset: Dataset, *, strict: bool) -> None:
        """Open a dataset; without `strict`, time may decrease and values may be implausible."""
        self.dataset, self.strict = dataset, strict
        self.cache: dict[str, Piece] = {}
        self.room = CACHE_VALUES
        self.rows = 0  # of all runs so far
        self.hashed = lru_cache(2 * len(dataset.runs))(self._hashed)

    def pieces(self, run: Run) -> Iterator[Piece]:
        """Yield the pieces of a run; short runs are cached up to `CACHE_VALUES`."""
        folder = self.dataset.folder
        if run.id in self.cache:
            yield self.cache[run.id]
        elif long := long_run(folder, run):
            yield from pieces(long, long.known, strict=self.strict)
        else:
            piece = Piece(0, dict(read_recording(folder, run, strict=self.strict).columns))
            values = piece.rows * len(piece.columns)
            if values <= self.room:
                self.room -= values
                self.cache[run.id] = piece
            yield piece

    def searched(self, run: Run, number: int) -> SearchedRun:
        """Return how a run is searched."""
        channels: dict[str, Resolution] = {}
        rows, begin_s, end_s, interval_s, increases = 0, 0.0, -math.inf, 0.0, True
        for piece in self.pieces(run):
            time_s = piece.columns[TIME]
            if piece.start == 0:
                begin_s, interval_s = float(time_s[0]), float(np.median(np.diff(time_s)))
            increases &= bool((np.diff(time_s, prepend=end_s) > 0.0).all())
            for name in sorted(piece.columns.keys() - channels.keys() - {*WITHOUT_EVIDENCE}):
                if (found := _resolution(piece.columns[name])) is not None:
                    channels[name] = found
            rows, end_s = piece.stop, float(time_s[-1])
        self.rows += rows
        whole = RowSpan(0, rows, begin_s, end_s)
        return SearchedRun(run, number, whole, interval_s, increases, channels)

    def _hashed(self, one: SearchedRun, grid: Grid) -> HashedRows:
        """Return the rows of a run; of a large dataset those that change, and a share of them.

        The share is by the hashes, so that of two copies it holds the same rows. Beside noise the
        other channels tell nothing, as commands are equal in every repeat; so do computed channels
        beside coarse ones.
        """
        share = 1 << max(math.ceil(math.log2(self.rows / MOST_ROWS)), 0)
        noisy = {name for name, step in grid if one.channels[name].noise > step}
        telling = noisy or {name for name, step in grid if step > 0.0} or {name for name, _ in grid}
        found = []
        for piece in self.pieces(one.run):
            hashes, nats = np.zeros(piece.rows, dtype=np.uint64), np.zeros(piece.rows)
            for name, step in grid:
                values = piece.columns[name]
                values = np.rint(values / step) if step else values.astype(np.float32).astype(float)
                values = np.where(np.isnan(values), np.nan, values + 0.0)  # one NaN, and one zero
                hashes = (hashes ^ values.view(np.uint64)) * _FACTOR
                hashes ^= hashes >> _HALF
                if name in telling:
                    changed = np.isfinite(values[1:]) & (values[1:] != values[:-1])
                    nats[1:] += (NOISY if noisy else QUIET) * changed
            kept = np.arange(piece.rows)
            if share > 1:
                kept = kept[1:][hashes[1:] != hashes[:-1]]
                kept = kept[hashes[kept] % np.uint64(share) == 0]
            nats = np.minimum(nats[kept], MOST_PER_ROW)
            found.append((piece.columns[TIME][kept], piece.start + kept, hashes[kept], nats))
        time_s, row, hashes, nats = map(np.concatenate, zip(*found, strict=True))
        _, first = np.unique(hashes, return_index=True)
        return HashedRows(time_s, row, hashes, nats, bool(noisy), first)


def common_grid(one: SearchedRun, other: SearchedRun) -> Grid:
    """Return the channels that two runs share, and what their values are rounded to.

    That is the coarser step, or a share of the noise where it is far more; 0 is single precision.
    """
    grid = []
    for name in sorted(one.channels.keys() & other.channels.keys()):
        a, b = one.channels[name], other.channels[name]
        step, fine = max(a.step, b.step), NOISE_SHARE * max(a.noise, b.noise)
        grid.append((name, step if 4.0 * step >= fine else fine))
    return tuple(grid)


def _resolution(values: Floats) -> Resolution | None:
    """Return the resolution of a channel, from its first change on; None if it does not vary."""
    values = values[np.isfinite(values)]
    changes = np.flatnonzero(np.diff(values))
    if changes.size == 0:
        return None
    values = values[changes[0] :][:SAMPLE]
    step, noise = step_of(values), calm_noise(values)
    visible = noise > max(step, SINGLE_PRECISION * np.abs(values).max()) and alternates(values)
    return Resolution(float(f"{step:.6g}"), 2.0 ** math.floor(math.log2(noise)) if visible else 0.0)
