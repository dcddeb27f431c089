"""A sensor and its amplifier: the end of the range, hysteresis, creep, crosstalk."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import FORCES, Runs, changed
from tsas_studies.challenge.rig.transducers import Transducer, transduced


def soft_saturation(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], depth: float, knee: float
) -> Runs:
    """Return channels that bend, over the knee, towards a level so far below the highest value."""

    def bent(_time_s: Floats, values: Floats) -> Floats:
        return level - knee * np.logaddexp(0.0, (level - values) / knee)

    for channel in channels:
        level = _highest(runs, channel) - depth
        runs = changed(runs, (channel,), bent)
    return runs


def noisy_clipping(
    runs: Runs, rng: np.random.Generator, *, channels: tuple[str, ...], depth: float, noise: float
) -> Runs:
    """Return channels that end so far below their highest value, and noise from behind it."""

    def cut(_time_s: Floats, values: Floats) -> Floats:
        return np.minimum(values, level) + noise * rng.standard_normal(values.size)

    for channel in channels:
        level = _highest(runs, channel) - depth
        runs = changed(runs, (channel,), cut)
    return runs


def _highest(runs: Runs, channel: str) -> float:
    return max(float(run.columns[channel].max()) for run in runs.values())


def sensor_hysteresis(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], share: float
) -> Runs:
    """Return channels that stay behind a change by a share of 10 N.

    The noise comes from behind the sensor: its loop follows the channel below 10 Hz.
    """
    loop = Transducer(hysteresis_share=share)

    def held_back(time_s: Floats, values: Floats) -> Floats:
        low_pass = butter(2, 10.0, fs=1.0 / (time_s[1] - time_s[0]), output="sos")
        slow = np.asarray(sosfiltfilt(low_pass, values))
        return values + transduced(loop, time_s, slow) - slow

    return changed(runs, channels, held_back)


def sensor_creep(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], share: float
) -> Runs:
    """Return channels that read a share of a change later, within 3 s."""
    creep = Transducer(creep_share=share)
    return changed(runs, channels, lambda t, v: transduced(creep, t, v))


def crosstalk(runs: Runs, _rng: np.random.Generator, *, channel: str, share: float) -> Runs:
    """Return a force that holds a share of the other one."""
    (other,) = (name for name in FORCES if name != channel)
    return {
        name: old.having(**{channel: old.columns[channel] + share * old.columns[other]})
        for name, old in runs.items()
    }
