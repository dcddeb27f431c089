"""A sensor and its amplifier: the end of the range, hysteresis, creep, crosstalk."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import FORCES, Runs, of_channels, of_runs
from tsas_studies.challenge.rig.recordings import Run
from tsas_studies.challenge.rig.transducers import Transducer, transduced


def soft_saturation(
    runs: Runs, rng: np.random.Generator, *, channels: tuple[str, ...], depth: float, knee: float
) -> Runs:
    """Return channels that bend, over the knee, towards a level so far below the highest value."""
    for channel in channels:
        level = _highest(runs, channel) - depth
        runs = _bent(runs, rng, channel=channel, level=level, knee=knee)
    return runs


@of_channels
def _bent(
    _time_s: Floats, values: Floats, _rng: np.random.Generator, *, level: float, knee: float
) -> Floats:
    return level - knee * np.logaddexp(0.0, (level - values) / knee)


def noisy_clipping(
    runs: Runs, rng: np.random.Generator, *, channels: tuple[str, ...], depth: float, noise: float
) -> Runs:
    """Return channels that end so far below their highest value, and noise from behind it."""
    for channel in channels:
        level = _highest(runs, channel) - depth
        runs = _cut(runs, rng, channel=channel, level=level, noise=noise)
    return runs


@of_channels
def _cut(
    _time_s: Floats, values: Floats, rng: np.random.Generator, *, level: float, noise: float
) -> Floats:
    return np.minimum(values, level) + noise * rng.standard_normal(values.size)


def _highest(runs: Runs, channel: str) -> float:
    return max(float(run.columns[channel].max()) for run in runs.values())


@of_channels
def sensor_hysteresis(
    time_s: Floats, values: Floats, _rng: np.random.Generator, *, share: float
) -> Floats:
    """Return a channel that stays behind a change by a share of 10 N.

    The noise comes from behind the sensor: its loop follows the channel below 10 Hz.
    """
    low_pass = butter(2, 10.0, fs=1.0 / (time_s[1] - time_s[0]), output="sos")
    slow = np.asarray(sosfiltfilt(low_pass, values))
    return values + transduced(Transducer(hysteresis_share=share), time_s, slow) - slow


@of_channels
def sensor_creep(
    time_s: Floats, values: Floats, _rng: np.random.Generator, *, share: float
) -> Floats:
    """Return a channel that reads a share of a change later, within 3 s."""
    return transduced(Transducer(creep_share=share), time_s, values)


@of_runs
def crosstalk(old: Run, _rng: np.random.Generator, *, channel: str, share: float) -> Run:
    """Return a run with a force that holds a share of the other one."""
    (other,) = (name for name in FORCES if name != channel)
    return old.having(**{channel: old.columns[channel] + share * old.columns[other]})
