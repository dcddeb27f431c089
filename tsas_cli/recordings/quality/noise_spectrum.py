"""The spectrum of a channel's noise, from short segments in which the motion is smooth."""

from typing import NamedTuple

import numpy as np

from tsas_cli.support.arrays import Floats, Mask

_DEGREE = 4  # of the polynomial that is taken out of a segment
_FEWEST_ROWS = 32
_MOST_SEGMENTS = 400  # evenly spread
_LOWEST = 2  # periods in a segment: below, the polynomial takes most of the noise away
_BAND = 1.25  # ratio of the ends of a band
_CALM, _USUAL = 0.1, 0.4  # quantiles over the segments
_STEADY = 0.5  # the same ratio of one line
_ALIKE = 0.15  # ratio of their powers that noise has at least, and a motion seldom


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


def noise_spectrum(time_s: Floats, values: Floats, segment_s: float) -> NoiseSpectrum | None:
    """Return the spectrum of the noise of evenly sampled values; None for too few segments.

    Parameters
    ----------
    time_s, values
        Shape (n,); without gaps.
    segment_s
        Length of a segment [s].
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
    power = np.abs(np.fft.rfft(left, axis=1)) ** 2 * 2.0 * step / float(window @ window)
    frequency = np.fft.rfftfreq(rows, step)
    inside = _bands(frequency.size)
    of_band = np.array([power[:, at].mean(axis=1) for at in inside])
    calm, usual = np.quantile(of_band, (_CALM, _USUAL), axis=1)
    return NoiseSpectrum(
        np.array([frequency[at].mean() for at in inside]),
        usual,
        calm > _ALIKE * usual,
        calm > _STEADY * usual,
    )


def _bands(count: int) -> list[slice]:
    """Return the bands of so many frequencies, a quarter of an octave wide, two at least."""
    bands, first = [], _LOWEST
    while first + 1 < count:
        width = max(2, round(first * (_BAND - 1.0)))
        bands.append(slice(first, min(first + width, count)))
        first += max(1, width // 2)
    return bands
