"""What an amplifier or a driver does to a channel, its noise included, before it is written."""

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import butter, lfilter, lfilter_zi, sosfiltfilt

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import Runs, changed


def low_pass(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], cut_Hz: float, order: int
) -> Runs:
    """Return the channels behind a causal Butterworth filter that has settled at the start."""

    def filtered(time_s: Floats, values: Floats) -> Floats:
        b, a = butter(order, cut_Hz, fs=_sampling_rate(time_s))
        return np.asarray(lfilter(b, a, values, zi=values[:20].mean() * lfilter_zi(b, a))[0])

    return changed(runs, channels, filtered)


def zero_phase_low_pass(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], cut_Hz: float
) -> Runs:
    """Return the channels filtered forwards and backwards."""

    def filtered(time_s: Floats, values: Floats) -> Floats:
        return np.asarray(
            sosfiltfilt(butter(2, cut_Hz, fs=_sampling_rate(time_s), output="sos"), values)
        )

    return changed(runs, channels, filtered)


def median(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], window_s: float
) -> Runs:
    """Return the channels as the median of a window about each sample."""

    def filtered(time_s: Floats, values: Floats) -> Floats:
        rows = 2 * int(0.5 * window_s * _sampling_rate(time_s)) + 1
        return np.asarray(median_filter(values, rows, mode="nearest"))

    return changed(runs, channels, filtered)


def ac_coupled(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], time_s: float
) -> Runs:
    """Return the channels behind a capacitor that begins to discharge at the start."""

    def coupled(at_s: Floats, values: Floats) -> Floats:
        decay = np.exp(-(at_s[1] - at_s[0]) / time_s)
        return np.asarray(lfilter([1.0, -1.0], [1.0, -decay], values))

    return changed(runs, channels, coupled)


def held(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], rate_Hz: float
) -> Runs:
    """Return the channels as a slower device gives them, each value until the next one."""

    def last(time_s: Floats, values: Floats) -> Floats:
        ticks = np.floor(time_s * rate_Hz + 1e-9) / rate_Hz
        return values[np.searchsorted(time_s, ticks - 1e-9)]

    return changed(runs, channels, last)


def _sampling_rate(time_s: Floats) -> float:
    return 1.0 / float(time_s[1] - time_s[0])
