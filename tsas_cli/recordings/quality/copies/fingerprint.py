"""What a run is recognised by: how fine each channel is, and a few short stretches of it."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.numerics.interpolated import interpolated
from tsas_cli.numerics.noise import noise_sd
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece
from tsas_cli.recordings.quality.copies.agreement import Floats, Indices, Mask, Samples
from tsas_cli.recordings.quality.copies.copy import Span
from tsas_cli.recordings.quality.samples import alternates, step_of
from tsas_cli.support import limits

SAME = 0.05  # of the noise, by which a copy may be off; a repeat is off by more than the noise
ROUNDED = 2e-7  # of the largest value, what single precision leaves
CANDIDATES = 3  # the samples on either side, and the line between them
CERTAIN = 0.95  # chance that a channel without noise repeats a change in a repeat of the motion
STRETCHES, LONG = 16, 4096  # of a piece, by which its noise is told
SHORT = 16, 128  # rows of a stretch by which a run is recognised, with noise and without
LEVELS = 1024  # of a channel
SPARSE = 1 / 128  # of a piece's samples, of which fewer are in a level while it moves
PLACES = (0.0, 0.5)  # of them in a piece; one more is at its end
BESIDE_MOTION = ("f_out_ref_N", "temperature_C")  # columns that are no evidence of anything


@dataclass(frozen=True)
class Fineness:
    """How fine a channel is, in its unit: noise, step of quantisation, largest value and span.

    `noisy` says whether the noise is seen: a computed channel has none, and of a coarse one the
    steps hide it.
    """

    noise: float
    step: float
    largest: float
    span: float
    noisy: bool

    def tolerance(self, step: float) -> float:
        """Return by how much a copy may be off that was rounded to some step.

        A step that is coarser than the noise would let any repeat pass.
        """
        rounded = 0.5 * step if step <= self.noise else 0.0
        return SAME * self.noise + ROUNDED * self.largest + rounded

    def news(self, tolerance: float) -> float:
        """Return how unlikely it is that a repeat meets a sample that changes [nats]."""
        chance = CERTAIN
        if self.noisy:
            met = max(2.0 * tolerance, self.step) / (2.0 * math.sqrt(math.pi) * self.noise)
            chance = min(CANDIDATES * met, CERTAIN)
        return -math.log(chance)


@dataclass(frozen=True, eq=False)
class Fingerprint:
    """A run: all of it, its channels, and short stretches of it.

    `channels` holds those that vary. Each of the stretches has k samples, between which something
    changes, of the channels `dense`: their times have the shape (h, k), the values (h, k, d). Of a
    run whose time does not increase nothing is known.
    """

    run: Run
    all: Span
    channels: dict[str, Fineness]
    dense: tuple[str, ...]
    stretches_s: Floats
    stretches: Floats
    increases: bool = True
    laid_between: bool = False  # on straight lines between samples of a slower clock

    @property
    def evidence(self) -> set[str]:
        """The channels that tell something of the rig."""
        return self.channels.keys() - set(BESIDE_MOTION)

    @property
    def noisy(self) -> bool:
        """Whether the noise of a channel is seen."""
        return any(one.noisy for one in self.channels.values())

    @property
    def interval_s(self) -> float:
        """Time from sample to sample, on average [s]."""
        return self.all.lasts_s / (self.all.rows - 1)


def fingerprint(run: Run, parts: Iterable[Piece]) -> Fingerprint:
    """Return what a run is recognised by.

    Raises
    ------
    InputError
        The run cannot be read.
    """
    seen: dict[str, _Channel] = {}
    dense: tuple[str, ...] = ()
    stretches: dict[int, list[Samples]] = {length: [] for length in SHORT}
    rows, begin_s, end_s, increases = 0, 0.0, 0.0, True
    for part in parts:
        time_s = part.columns[TIME]
        steps_s = np.diff(time_s, prepend=end_s if part.start else time_s[0] - 1.0)
        increases &= bool(
            ((steps_s >= limits.SHORTEST_STEP_S) & (steps_s <= limits.LONGEST_STEP_S)).all()
        )
        if part.start == 0:
            begin_s = float(time_s[0])
            seen = {name: _Channel() for name in part.columns if name != TIME}
            dense = tuple(name for name in seen if _is_dense(part.columns[name]))
        for name, channel in seen.items():
            channel.add(part.columns[name])
        for length, samples in _stretches(part, dense):
            stretches[length].append(samples)
        rows, end_s = part.stop, float(time_s[-1])
    told = {name: channel.fineness() for name, channel in seen.items()}
    chosen = stretches[SHORT[0] if any(one.noisy for one in told.values()) else SHORT[1]]
    return Fingerprint(
        run,
        Span(0, rows, begin_s, end_s),
        {name: one for name, one in told.items() if one.span > 0.0},
        dense,
        np.array([s.time_s for s in chosen]),
        np.array([s.values for s in chosen]),
        increases,
        any(channel.laid_between for channel in seen.values()),
    )


class _Channel:
    """What one channel shows, piece by piece."""

    def __init__(self) -> None:
        self.noise: list[float] = []
        self.alternates: list[bool] = []
        self.kept: list[Floats] = []
        self.lowest, self.highest = math.inf, -math.inf
        self.laid_between = False

    def add(self, values: Floats) -> None:
        there = values[np.isfinite(values)]
        if there.size == 0:
            return
        self.lowest = min(self.lowest, float(there.min()))
        self.highest = max(self.highest, float(there.max()))
        starts = np.linspace(0, max(there.size - LONG, 0), STRETCHES, dtype=np.int64)
        few = there.size <= STRETCHES * LONG
        stretches = [there] if few else [there[k : k + LONG] for k in starts.tolist()]
        self.noise += [sd for sd in map(noise_sd, stretches) if math.isfinite(sd)]
        self.alternates += map(alternates, stretches)
        self.kept += stretches if len(self.kept) < STRETCHES else []
        self.laid_between |= bool(interpolated(values[: STRETCHES * LONG]).any())

    def fineness(self) -> Fineness:
        span = self.highest - self.lowest
        if not 0.0 < span < math.inf:
            return Fineness(0.0, 0.0, 0.0, 0.0, noisy=False)
        noise = float(np.median(self.noise)) if self.noise else 0.0
        step = step_of(np.concatenate(self.kept))
        largest = max(abs(self.lowest), abs(self.highest))
        noisy = 2 * sum(self.alternates) > len(self.alternates)
        noisy = noisy and noise > max(0.5 * step, ROUNDED * largest)
        return Fineness(noise, step, largest, span, noisy)


def _is_dense(values: Floats) -> bool:
    """Say whether most rows hold a value of a channel, which is not always the same."""
    there = np.isfinite(values)
    return bool(2 * there.sum() > values.size and np.ptp(values[there]) > 0.0)


def _stretches(part: Piece, names: Sequence[str]) -> Iterator[tuple[int, Samples]]:
    """Yield lengths and stretches of rows in which something changes, from all over a piece."""
    if not names:
        return
    values = np.column_stack([part.columns[name] for name in names])
    changing: Mask = np.all(np.isfinite(values), axis=1)
    changing[1:] &= np.any(values[1:] != values[:-1], axis=1)
    at = np.flatnonzero(changing)
    if at.size == 0:
        return
    crowd = np.min([_crowd(each[at]) for each in values.T], axis=0)
    calm = at[crowd <= SPARSE * at.size]  # at rest samples are alike
    for length in SHORT:
        rows = calm if calm.size >= length else at
        if rows.size >= length:
            first = np.searchsorted(rows, [place * part.rows for place in PLACES])
            for start in np.unique(np.minimum([*first, rows.size], rows.size - length)).tolist():
                chosen = rows[start : start + length]
                yield length, Samples(part.columns[TIME][chosen], values[chosen])


def _crowd(values: Floats) -> Indices:
    """Return how many samples are about as large as each one, shape (n,)."""
    span = np.ptp(values)
    share = (values - values.min()) / span if span > 0.0 else np.zeros(values.size)
    level = (share * (LEVELS - 1)).astype(np.int64)
    return np.asarray(np.bincount(level)[level])
