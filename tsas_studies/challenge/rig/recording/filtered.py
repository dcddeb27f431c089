"""What an amplifier or a driver does to a channel, its noise included, before it is written."""

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import butter, lfilter, lfilter_zi, sosfiltfilt

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import of_channels


@of_channels
def low_pass(
    time_s: Floats, values: Floats, _rng: np.random.Generator, *, cut_Hz: float, order: int
) -> Floats:
    """Return a channel behind a causal Butterworth filter that has settled at the start."""
    b, a = butter(order, cut_Hz, fs=_sampling_rate(time_s))
    return np.asarray(lfilter(b, a, values, zi=values[:20].mean() * lfilter_zi(b, a))[0])


@of_channels
def zero_phase_low_pass(
    time_s: Floats, values: Floats, _rng: np.random.Generator, *, cut_Hz: float
) -> Floats:
    """Return a channel filtered forwards and backwards."""
    sections = butter(2, cut_Hz, fs=_sampling_rate(time_s), output="sos")
    return np.asarray(sosfiltfilt(sections, values))


@of_channels
def median(time_s: Floats, values: Floats, _rng: np.random.Generator, *, window_s: float) -> Floats:
    """Return a channel as the median of a window about each sample."""
    rows = 2 * int(0.5 * window_s * _sampling_rate(time_s)) + 1
    return np.asarray(median_filter(values, rows, mode="nearest"))


@of_channels
def ac_coupled(at_s: Floats, values: Floats, _rng: np.random.Generator, *, time_s: float) -> Floats:
    """Return a channel behind a capacitor that begins to discharge at the start."""
    decay = np.exp(-(at_s[1] - at_s[0]) / time_s)
    return np.asarray(lfilter([1.0, -1.0], [1.0, -decay], values))


@of_channels
def held(time_s: Floats, values: Floats, _rng: np.random.Generator, *, rate_Hz: float) -> Floats:
    """Return a channel as a slower device gives it, each value until the next one."""
    ticks = np.floor(time_s * rate_Hz + 1e-9) / rate_Hz
    return values[np.searchsorted(time_s, ticks - 1e-9)]


def _sampling_rate(time_s: Floats) -> float:
    return 1.0 / float(time_s[1] - time_s[0])
