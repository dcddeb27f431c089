"""Properties of the samples of one channel: quantisation, noise, spectrum, outliers, plateaus."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.noise import noise_sd, quantisation_step, third_differences
from tsas_cli.support.arrays import Complex, Floats, Mask

_DEGREE = 4  # of the polynomial that is taken out of a segment
_FEWEST_ROWS = 32
_MOST_SEGMENTS = 400  # evenly spread
_LOWEST = 2  # periods in a segment: below, the polynomial takes most of the noise away
_BAND = 1.25  # ratio of the ends of a band
_CALM, _USUAL = 0.1, 0.4  # quantiles over the segments
_STEADY = 0.5  # the same ratio of one line
_ALIKE = 0.15  # ratio of their powers that noise has at least, and a motion seldom
_MOST_IN_A_ROW = 3
_NOISE, _STEPS, _SPAN = 20.0, 10.0, 0.05  # least deviation, in noise, in steps and in the span
_NEIGHBOURS = 16  # samples on either side that the steepness is compared with
_STEEPER = 10.0  # than those: a motion that reverses within a few samples has steep neighbours
_COMMON = 0.02  # of all samples: more frequent deviations are the signal
_FEWEST = 16  # samples for an estimate of the noise
_FEWEST_CHANGES = 20
_BLOCK = 16  # rows


class NoiseSpectrum(NamedTuple):
    """Power per hertz of a channel's calm segments in bands [unit²/Hz], and what each is.

    All have the shape (bands,). In a band of noise the power is nearly the same in every segment;
    that of a motion, of which a polynomial leaves a part, differs by orders of magnitude. That of a
    line is as steady as no noise is.
    """

    frequency_Hz: Floats
    power: Floats
    is_noise: Mask
    is_steady: Mask


@dataclass(frozen=True)
class Size:
    """Noise (standard deviation), quantisation step, span and ends of one channel, in its unit.

    The step is 0 without quantisation; the span leaves out the outermost thousandth at either end.
    """

    noise: float
    step: float
    span: float
    lowest: float
    highest: float


def size_of(values: Floats, time_s: Floats) -> Size:
    """Return the size of a channel at given times, shapes (n,)."""
    ends = float(np.nanmin(values)), float(np.nanmax(values))
    return Size(noise_sd(values, time_s), step_of(values), span_of(values), *ends)


def step_of(values: Floats) -> float:
    """Return the quantisation step, 0 without quantisation.

    A channel that seldom repeats a level shows its step in the increments.
    """
    increments = np.round(np.diff(values), 12)
    return quantisation_step(values) or quantisation_step(increments)


def span_of(values: Floats) -> float:
    """Return the span of a channel, without the outermost thousandth at either end."""
    return float(np.ptp(np.nanpercentile(values, (0.1, 99.9))))


def alternates(values: Floats) -> bool:
    """Return whether a channel, shape (n,), is noisy.

    Third differences alternate for noise, not for motion.
    """
    clean = values[np.isfinite(values)]
    third = np.diff(clean, 3)
    third = third[np.abs(third) > 1e-9 * np.abs(clean).max(initial=0.0)]
    return third.size >= _FEWEST and bool(np.mean(third[1:] * third[:-1] < 0.0) > 0.5)


def calm_noise(values: Floats) -> float:
    """Return the noise in the calmest quarter of blocks of rows [unit]; NaN without a whole one."""
    third = third_differences(values)
    blocks = third[: third.size // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    level = np.sqrt(np.mean(blocks**2, axis=1))
    level = level[np.isfinite(level)]
    return float(np.quantile(level, 0.25)) if level.size else np.nan


def rows_between_changes(values: Floats) -> npt.NDArray[np.int64]:
    """Return the number of rows from each change of a channel to the next."""
    return np.diff(np.flatnonzero(values[1:] != values[:-1]))


def is_held(values: Floats) -> bool:
    """Return whether a channel changes in every second row at most."""
    rows = rows_between_changes(values)
    return rows.size >= _FEWEST_CHANGES and bool(np.quantile(rows, 0.05) >= 2.0)


def smallest_change(values: Floats) -> float:
    """Return the smallest change from row to row beyond rounding; infinite without a change."""
    change = np.abs(np.diff(values))
    rounding = 1e-9 * np.nanmax(np.abs(values))
    return float(np.min(change, where=change > rounding, initial=np.inf))


def plateaus(values: Floats, shortest: int) -> list[slice]:
    """Return the stretches of at least `shortest` rows in which a channel, shape (n,), is constant.

    NaN belongs to no stretch.
    """
    changes = np.flatnonzero(values[1:] != values[:-1]) + 1
    edges = np.concatenate(([0], changes, [values.size]))
    long = np.flatnonzero(np.diff(edges) >= shortest)
    return [slice(int(edges[i]), int(edges[i + 1])) for i in long]


def outlying(time_s: Floats, values: Floats, size: Size, *, most: float) -> Mask:
    """Return which samples are outliers, shape (n,).

    An outlier is an implausible value, or one of up to three consecutive samples that deviate from
    the samples before and after them to the same side by far more than noise, quantisation and the
    neighbouring motion explain. A lasting step is none. The first and the last samples have one
    neighbour only, so they have to deviate by more than the span.

    Times and values have the shape (n,), gaps are NaN; `most` is the largest plausible magnitude.
    The size is that of the whole channel; its noise is NaN if it is unknown.
    """
    with np.errstate(all="ignore"):  # a stray 1e300 may overflow
        found = np.abs(values) > most
        if not size.span > 0.0:  # a single other value in a constant channel may be its step
            return found
        valid = np.flatnonzero(np.isfinite(values) & ~found)
        # With an outlier of 1e9, all other levels count as one and the step is the outlier.
        steps = _STEPS * size.step if size.step <= size.span else 0.0
        least = max(_SPAN * size.span, steps, _NOISE * np.nan_to_num(size.noise))
        found[valid[_deviating(time_s[valid], values[valid], least, size.span)]] = True
    return found


def _deviating(time_s: Floats, values: Floats, least: float, span: float) -> Mask:
    """Return which of the finite samples deviate from both neighbours, shape (n,)."""
    found = np.zeros(values.size, dtype=np.bool_)
    if values.size <= 2 * _MOST_IN_A_ROW:
        return found
    apart = 1.5 * float(np.median(np.diff(time_s)))
    change = np.abs(np.diff(values))
    # The missing neighbour of the first and the last sample is taken as equal to the other one.
    before, after = np.r_[np.nan, values[:-1]], np.r_[values[1:], np.nan]
    lowest = highest = values  # of so many in a row
    for count in range(1, _MOST_IN_A_ROW + 1):
        if count > 1:
            lowest = np.minimum(lowest[:-1], values[count - 1 :])
            highest = np.maximum(highest[:-1], values[count - 1 :])
        left, right = before[: lowest.size], after[count - 1 :]
        above = lowest - np.fmax(left, right)
        below = np.fmin(left, right) - highest
        off = np.maximum(above, below)
        needed = np.full(off.size, least)
        needed[[0, -1]] = max(least, span)
        starts = np.flatnonzero(off > needed)
        if starts.size > _COMMON * values.size:
            continue
        for start in starts.tolist():
            stop = start + count
            long = np.diff(time_s[max(start - 1, 0) : stop + 1]) > apart
            beside = np.r_[
                change[max(start - 1 - _NEIGHBOURS, 0) : max(start - 1, 0)],
                change[stop : stop + _NEIGHBOURS],
            ]
            if not long.any() and off[start] > _STEEPER * beside.max(initial=0.0):
                found[start:stop] = True
    return found


def noise_spectrum(time_s: Floats, values: Floats, segment_s: float) -> NoiseSpectrum | None:
    """Return the spectrum of the noise of evenly sampled values; None for too few segments.

    Times and values have the shape (n,), without gaps; `segment_s` is the length of a segment [s].
    """
    found = _of_segments(time_s, values, segment_s)
    if found is None:
        return None
    frequency, spectra = found
    power = np.abs(spectra) ** 2
    inside = _bands(frequency.size)
    of_band = np.array([power[:, at].mean(axis=1) for at in inside])
    calm, usual = np.quantile(of_band, (_CALM, _USUAL), axis=1)
    return NoiseSpectrum(
        np.array([frequency[at].mean() for at in inside]),
        usual,
        calm > _ALIKE * usual,
        calm > _STEADY * usual,
    )


def locked_phase(
    time_s: Floats, values: Floats, other: Floats, segment_s: float
) -> tuple[Floats, Floats]:
    """Return frequencies [Hz] and how alike the phase between two channels is in all segments.

    1 where it is always the same, about one over the number of segments for independent noise. Each
    segment counts alike, so that a few in which a motion is larger than the noise count little. The
    channels are as for `noise_spectrum`, with enough segments.
    """
    both = [_of_segments(time_s, one, segment_s) for one in (values, other)]
    (frequency, first), (_, second) = (found for found in both if found is not None)
    cross = first * second.conj()
    size = np.abs(cross)
    phase = np.divide(cross, size, out=np.zeros_like(cross), where=size > 0.0)
    return frequency, np.abs(phase.mean(axis=0)) ** 2


def _of_segments(time_s: Floats, values: Floats, segment_s: float) -> tuple[Floats, Complex] | None:
    """Return frequencies (k,) [Hz] and the spectra of segments without their slow motion, (m, k).

    Their squares are power per hertz. None for too few segments.
    """
    step = float(time_s[-1] - time_s[0]) / (time_s.size - 1)
    rows = max(round(segment_s / step), _FEWEST_ROWS)
    starts = np.arange(0, values.size - rows + 1, rows // 2)
    if starts.size < 10:
        return None
    starts = starts[:: -(-starts.size // _MOST_SEGMENTS)]
    segments = np.lib.stride_tricks.sliding_window_view(values, rows)[starts]
    basis = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, rows), _DEGREE + 1))[0]
    window = np.hanning(rows + 2)[1:-1]
    left = (segments - (segments @ basis) @ basis.T) * window
    spectra = np.fft.rfft(left, axis=1) * np.sqrt(2.0 * step / float(window @ window))
    return np.asarray(np.fft.rfftfreq(rows, step), dtype=np.float64), spectra


def _bands(count: int) -> list[slice]:
    """Return the bands of so many frequencies, a quarter of an octave wide, two at least."""
    bands, first = [], _LOWEST
    while first + 1 < count:
        width = max(2, round(first * (_BAND - 1.0)))
        bands.append(slice(first, min(first + width, count)))
        first += max(1, width // 2)
    return bands
