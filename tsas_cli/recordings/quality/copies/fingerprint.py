"""Runs in pieces, and their fingerprints: the resolution of each channel, short stretches."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.numerics.noise import interpolated, noise_sd
from tsas_cli.recordings.columns import TIME, largest
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece, known_columns, long_run, pieces
from tsas_cli.recordings.quality.copies.agreement import MARGIN_ROWS, RowSpan, RunSamples
from tsas_cli.recordings.quality.samples import alternates, step_of
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats, Indices, Mask
from tsas_cli.support.errors import InputError

NOISE_SHARE = 0.05  # tolerance of a copy; a repeat deviates by more than the noise
SINGLE_PRECISION = 2e-7  # of the largest value, rounding of single precision
CANDIDATES = 3  # the samples on either side, and the interpolation between them
REPEAT_CHANCE = 0.95  # that a noiseless channel repeats a change in a repeat of the motion
STRETCHES, LONG = 16, 4096  # of a piece: number and rows, from which its noise is estimated
SHORT = 16, 128  # rows of a stretch that identifies a run, with noise and without
LEVELS = 1024  # of a channel
SPARSE = 1 / 128  # of a piece's samples: fewer per level are motion, more are rest
PLACES = (0.0, 0.5)  # of the stretches in a piece; one more is at its end
WITHOUT_EVIDENCE = ("f_out_ref_N", "temperature_C")  # columns that identify no run


@dataclass(frozen=True)
class Fineness:
    """Resolution of a channel, in its unit: noise, quantisation step, largest value and span.

    `noisy` is false if the noise is not visible: in a computed channel, or below coarse steps.
    """

    noise: float
    step: float
    largest: float
    span: float
    noisy: bool

    def tolerance(self, step: float) -> float:
        """Return the largest deviation of a copy that was rounded to a step.

        The rounding is not added for steps coarser than the noise: any repeat would agree.
        """
        rounded = 0.5 * step if step <= self.noise else 0.0
        return NOISE_SHARE * self.noise + SINGLE_PRECISION * self.largest + rounded

    def information(self, tolerance: float) -> float:
        """Return −ln of the probability that a repeat agrees with a changing sample [nats]."""
        chance = REPEAT_CHANCE
        if self.noisy:
            met = max(2.0 * tolerance, self.step) / (2.0 * math.sqrt(math.pi) * self.noise)
            chance = min(CANDIDATES * met, REPEAT_CHANCE)
        return -math.log(chance)


@dataclass(frozen=True, eq=False)
class Fingerprint:
    """A run: its span, its channels, and short stretches.

    `channels` holds those that vary. Each of the h stretches has k changing samples of the d
    channels `dense`: times (h, k), values (h, k, d). If time does not increase, the rest is void.
    """

    run: Run
    all: RowSpan
    channels: dict[str, Fineness]
    dense: tuple[str, ...]
    stretches_s: Floats
    stretches: Floats
    increases: bool = True
    interpolated: bool = False  # linearly between samples of a slower clock

    @property
    def evidence(self) -> set[str]:
        """The channels that identify a run."""
        return self.channels.keys() - set(WITHOUT_EVIDENCE)

    @property
    def noisy(self) -> bool:
        """Whether the noise of any channel is visible."""
        return any(one.noisy for one in self.channels.values())

    @property
    def interval_s(self) -> float:
        """Mean sample interval [s]."""
        return self.all.duration_s / (self.all.rows - 1)


def fingerprint(run: Run, parts: Iterable[Piece]) -> Fingerprint:
    """Return the fingerprint of a run."""
    channels: dict[str, _Channel] = {}
    dense: tuple[str, ...] = ()
    stretches: dict[int, list[RunSamples]] = {length: [] for length in SHORT}
    rows, begin_s, end_s, increases = 0, 0.0, 0.0, True
    for part in parts:
        time_s = part.columns[TIME]
        steps_s = np.diff(time_s, prepend=end_s if part.start else time_s[0] - 1.0)
        increases &= bool(
            ((steps_s >= limits.SHORTEST_STEP_S) & (steps_s <= limits.LONGEST_STEP_S)).all()
        )
        if part.start == 0:
            begin_s = float(time_s[0])
            channels = {name: _Channel() for name in part.columns if name != TIME}
            valid = {name: np.isfinite(part.columns[name]) for name in channels}
            dense = tuple(  # they vary and have values in most rows
                name
                for name, there in valid.items()
                if 2 * there.sum() > there.size and np.ptp(part.columns[name][there]) > 0.0
            )
        for name, channel in channels.items():
            channel.add(part.columns[name])
        for length, samples in _stretches(part, dense):
            stretches[length].append(samples)
        rows, end_s = part.stop, float(time_s[-1])
    resolution = {name: channel.fineness() for name, channel in channels.items()}
    chosen = stretches[SHORT[0] if any(one.noisy for one in resolution.values()) else SHORT[1]]
    return Fingerprint(
        run,
        RowSpan(0, rows, begin_s, end_s),
        {name: one for name, one in resolution.items() if one.span > 0.0},
        dense,
        np.array([s.time_s for s in chosen]),
        np.array([s.values for s in chosen]),
        increases,
        any(channel.interpolated for channel in channels.values()),
    )


class _Channel:
    """Statistics of one channel, accumulated over pieces."""

    def __init__(self) -> None:
        self.noise: list[float] = []
        self.alternates: list[bool] = []
        self.samples: list[Floats] = []
        self.lowest, self.highest = math.inf, -math.inf
        self.interpolated = False

    def add(self, values: Floats) -> None:
        valid = values[np.isfinite(values)]
        if valid.size == 0:
            return
        self.lowest = min(self.lowest, float(valid.min()))
        self.highest = max(self.highest, float(valid.max()))
        starts = np.linspace(0, max(valid.size - LONG, 0), STRETCHES, dtype=np.int64)
        few = valid.size <= STRETCHES * LONG
        stretches = [valid] if few else [valid[k : k + LONG] for k in starts.tolist()]
        self.noise += [sd for sd in map(noise_sd, stretches) if math.isfinite(sd)]
        self.alternates += map(alternates, stretches)
        self.samples += stretches if len(self.samples) < STRETCHES else []
        self.interpolated |= bool(interpolated(values[: STRETCHES * LONG]).any())

    def fineness(self) -> Fineness:
        span = self.highest - self.lowest
        if not 0.0 < span < math.inf:
            return Fineness(0.0, 0.0, 0.0, 0.0, noisy=False)
        noise = float(np.median(self.noise)) if self.noise else 0.0
        step = step_of(np.concatenate(self.samples))
        largest = max(abs(self.lowest), abs(self.highest))
        noisy = 2 * sum(self.alternates) > len(self.alternates)
        noisy = noisy and noise > max(0.5 * step, SINGLE_PRECISION * largest)
        return Fineness(noise, step, largest, span, noisy)


def _stretches(part: Piece, names: Sequence[str]) -> Iterator[tuple[int, RunSamples]]:
    """Yield lengths and stretches of changing rows, spread over a piece."""
    if not names:
        return
    values = np.column_stack([part.columns[name] for name in names])
    changing: Mask = np.all(np.isfinite(values), axis=1)
    changing[1:] &= np.any(values[1:] != values[:-1], axis=1)
    at = np.flatnonzero(changing)
    if at.size == 0:
        return
    crowd = np.min([_crowd(each[at]) for each in values.T], axis=0)
    calm = at[crowd <= SPARSE * at.size]  # at rest, samples are indistinguishable
    for length in SHORT:
        rows = calm if calm.size >= length else at
        if rows.size >= length:
            first = np.searchsorted(rows, [place * part.rows for place in PLACES])
            for start in np.unique(np.minimum([*first, rows.size], rows.size - length)).tolist():
                chosen = rows[start : start + length]
                yield length, RunSamples(part.columns[TIME][chosen], values[chosen])


def _crowd(values: Floats) -> Indices:
    """Return the number of samples in the level of each sample, shape (n,)."""
    span = np.ptp(values)
    share = (values - values.min()) / span if span > 0.0 else np.zeros(values.size)
    level = (share * (LEVELS - 1)).astype(np.int64)
    return np.asarray(np.bincount(level)[level])


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
    columns = piece.columns.items()
    return Piece(piece.start, {n: np.where(np.abs(v) <= largest(n), v, np.nan) for n, v in columns})


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
