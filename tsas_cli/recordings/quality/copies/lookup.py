"""Search of a source for a short stretch of another run, by the values of its samples alone.

The line segments between a source's samples are sorted into bins by one channel. A copied or
interpolated sample lies on one of the few segments in its bin; that segment determines the shift of
the clocks, at which the rest of the stretch has to agree with the source too.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.quality.copies.agreement import MARGIN_ROWS, RunSamples, agreement, aligned
from tsas_cli.support.arrays import Floats, Indices, Mask

BINS = 4096
BLOCK = 1 << 16  # segments that are sorted at once
ENTRIES = 3.0  # of a segment in the bins, on average at most
TRIED = 2  # samples of a stretch that are looked up
MOST_AT_ONCE = 1 << 18
CROWDED = 256, 1 / 128  # most segments in a bin that is searched: number, and share of all
CLOSEST = 4  # candidate shifts of one stretch that are refined
NEARLY = 0.1  # of a sample interval, within which two shifts are one
PARTS = (0.0, 0.1, 0.3)  # of the loose tolerance, at which closeness is evaluated
LOOSE = 0.5  # of the noise: splines deviate from linear interpolation by about a fifth of it
LOOSE_SHARE = 0.7  # of a stretch that agrees within the loose tolerance
TIGHT_SHARE = 0.85  # and within the tolerance
NOISELESS_SHARE = 0.97  # without noise, where most coarse samples agree with any repeat


@dataclass(frozen=True)
class Shift:
    """Shift of a stretch to a source's clock [s], and the kind of interpolation."""

    seconds: float
    spline: bool


class Lookup:
    """Index of a source's samples, for the search of stretches."""

    def __init__(self, source: RunSamples, tolerance: Floats, noise: Floats) -> None:
        """Index a source of at least two samples, with tolerance and noise of each channel.

        The noise is 0 if no channel shows it.
        """
        self.source, self.tolerance = source, tolerance
        self.enough = LOOSE_SHARE if noise.any() else NOISELESS_SHARE
        self.loose = tolerance + LOOSE * noise
        self.nearly_s = NEARLY * float(np.median(np.diff(source.time_s)))
        whole: Mask = np.all(np.isfinite(source.values), axis=1)
        pieces = np.flatnonzero(whole[1:] & whole[:-1])
        some = source.values[pieces[:: 1 + pieces.size // BLOCK]]
        # The channel that separates samples best.
        self.channel = int(
            np.argmin([_crowd(*each) for each in zip(some.T, self.loose, strict=True)])
        )
        values = source.values[:, self.channel]
        ends = values[pieces], values[pieces + 1]
        wide = self.loose[self.channel]
        lower, upper = np.minimum(*ends) - wide, np.maximum(*ends) + wide
        self.bins = [
            _Bins(lower[block], upper[block], pieces[block])
            for k in range(0, pieces.size, BLOCK)
            for block in [slice(k, k + BLOCK)]
        ]

    def shifts(self, time_s: Floats, values: Floats) -> Iterator[tuple[int, Shift]]:
        """Yield the number and the shift of each stretch that agrees with the source.

        The times of the stretches have the shape (h, k), the values (h, k, d).
        """
        for number, seconds in self._places(time_s, values):
            shift = self._tight(RunSamples(time_s[number], values[number]), seconds)
            if shift is not None:
                yield number, shift

    def _places(self, time_s: Floats, values: Floats) -> list[tuple[int, float]]:
        """Return number and shift of stretches that agree loosely, at most `CLOSEST` shifts each.

        They are the shifts of the closest agreement.
        """
        found: list[tuple[float, int, float]] = []
        for bins in self.bins:
            for stretch, row, piece in bins.looked_up(values[:, :, self.channel]):
                met, at_s = self._on_piece(values[stretch, row], piece)
                shift_s = at_s[met] - time_s[stretch[met], row[met]]
                found += self._followed(time_s, values, stretch[met], shift_s)
        chosen: dict[int, list[float]] = {}
        for _, number, seconds in sorted(found, reverse=True):
            known = chosen.setdefault(number, [])
            if len(known) < CLOSEST and all(abs(seconds - s) > self.nearly_s for s in known):
                known.append(seconds)
        return [(number, seconds) for number, known in chosen.items() for seconds in known]

    def _on_piece(self, values: Floats, piece: Indices) -> tuple[Mask, Floats]:
        """Return which samples agree loosely with their segments, and their times on its clock."""
        source = self.source
        before = source.values[piece]
        step = (source.values[piece + 1] - before) / self.loose
        off = (values - before) / self.loose
        length = np.sum(step**2, axis=1)
        share = np.divide(
            np.sum(step * off, axis=1), length, out=np.zeros(piece.size), where=length > 0.0
        )
        share = np.clip(share, 0.0, 1.0)
        met = (np.abs(off - share[:, None] * step) <= 1.0).all(axis=1)
        start_s = source.time_s[piece]
        return met, start_s + share * (source.time_s[piece + 1] - start_s)

    def _followed(
        self, time_s: Floats, values: Floats, stretch: Indices, shift_s: Floats
    ) -> list[tuple[float, int, float]]:
        """Return closeness, number and shift of each stretch that agrees loosely."""
        for step in (values.shape[1] // 4, 1):
            at_s = time_s[stretch, ::step] + shift_s[:, None]
            lie = self._share(at_s, values[stretch, ::step], self.loose)
            stretch, shift_s = stretch[lie >= self.enough], shift_s[lie >= self.enough]
        at_s, there = time_s[stretch] + shift_s[:, None], values[stretch]
        tolerances = [self.tolerance + part * self.loose for part in PARTS]
        close = np.sum([self._share(at_s, there, each) for each in tolerances], axis=0)
        return list(zip(close.tolist(), stretch.tolist(), shift_s.tolist(), strict=True))

    def _share(self, at_s: Floats, values: Floats, tolerance: Floats) -> Floats:
        """Return the share of each stretch, (m, k, d) at (m, k), that agrees, shape (m,)."""
        samples = RunSamples(at_s.ravel(), values.reshape(-1, values.shape[2]))
        agrees = agreement(self.source, samples, tolerance).agrees.reshape(at_s.shape)
        return np.asarray(agrees.mean(axis=1))

    def _tight(self, stretch: RunSamples, seconds: float) -> Shift | None:
        """Return the refined shift of a stretch, with either interpolation; or None."""
        moved = stretch.moved(seconds)
        first, last = np.searchsorted(self.source.time_s, moved.time_s[[0, -1]]).tolist()
        near = self.source.part(slice(max(first - MARGIN_ROWS, 0), last + MARGIN_ROWS))
        for spline in (False, True):
            by_s = aligned(near, moved, self.tolerance, spline=spline)
            found = agreement(near, moved.moved(by_s), self.tolerance, spline=spline)
            if found.agrees.mean() >= TIGHT_SHARE:
                return Shift(seconds + by_s, spline)
        return None


def _crowd(values: Floats, apart: float) -> float:
    """Return the summed squared number of samples per bin of the resolution `apart`."""
    if values.size == 0:
        return 0.0
    width = max(float(np.ptp(values)) / BINS, apart)
    return float(np.sum(np.bincount(((values - values.min()) / width).astype(np.int64)) ** 2.0))


class _Bins:
    """Line segments sorted by the values of one channel that each one covers."""

    def __init__(self, lower: Floats, upper: Floats, pieces: Indices) -> None:
        self.origin = float(lower.min())
        span = float(upper.max()) - self.origin
        self.width = max(span / BINS, float(np.sum(upper - lower)) / (ENTRIES * pieces.size))
        first = ((lower - self.origin) / self.width).astype(np.int64)
        counts = ((upper - self.origin) / self.width).astype(np.int64) - first + 1
        starts = np.cumsum(counts) - counts
        bins = np.arange(int(counts.sum())) + np.repeat(first - starts, counts)
        order = np.argsort(bins, kind="stable")
        self.pieces = np.repeat(pieces, counts)[order]
        self.edges = np.searchsorted(bins[order], np.arange(BINS + 3))

    def looked_up(self, values: Floats) -> Iterator[tuple[Indices, Indices, Indices]]:
        """Yield number of the stretch, number of its sample, and segment on which that may lie.

        Of each stretch, (h, k), the `TRIED` samples in the emptiest bins are looked up.
        """
        number = (values - self.origin) / self.width
        inside = (number >= 0.0) & (number < BINS + 1)
        bins = np.where(inside, number, BINS + 1).astype(np.int64)  # the last one is empty
        crowd = self.edges[bins + 1] - self.edges[bins]
        row = np.argsort(crowd, axis=1, kind="stable")[:, :TRIED].ravel()
        stretch = np.repeat(np.arange(len(values)), TRIED)
        counts, first = crowd[stretch, row], self.edges[bins[stretch, row]]
        counts = np.where(counts <= max(CROWDED[0], CROWDED[1] * self.pieces.size), counts, 0)
        batch = np.cumsum(counts) // MOST_AT_ONCE
        for k in np.unique(batch[counts > 0]).tolist():
            here = np.flatnonzero((batch == k) & (counts > 0))
            each = counts[here]
            inner = np.arange(int(each.sum())) + np.repeat(
                first[here] - np.cumsum(each) + each, each
            )
            chosen = np.repeat(here, each)
            yield stretch[chosen], row[chosen], self.pieces[inner]
