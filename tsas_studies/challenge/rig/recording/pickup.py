"""What is added to a channel on its way: hum, noise, interference, values that are none."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import of_channels, of_runs
from tsas_studies.challenge.rig.recordings import Run


@of_channels
def random_walk(
    time_s: Floats, values: Floats, rng: np.random.Generator, *, per_root_s: float
) -> Floats:
    """Return a channel whose zero wanders."""
    steps = np.sqrt(time_s[1] - time_s[0]) * rng.standard_normal(values.size)
    return values + per_root_s * np.cumsum(steps)


@of_channels
def hum(
    time_s: Floats,
    values: Floats,
    rng: np.random.Generator,
    *,
    amplitude: float,
    frequency_Hz: float,
) -> Floats:
    """Return a channel with a sine of one frequency, its phase drawn for each run."""
    phase = rng.uniform(0.0, 2.0 * np.pi)
    return values + amplitude * np.sin(2.0 * np.pi * frequency_Hz * time_s + phase)


@of_runs
def sign_interference(
    old: Run, _rng: np.random.Generator, *, channels: tuple[str, ...], amplitude: float
) -> Run:
    """Return a run with channels that take up the direction in which the motor turns."""
    x = old.columns["x_in_mm"]
    rows = max(round(0.1 / (old.time_s[1] - old.time_s[0])), 3)
    smooth = np.convolve(np.pad(x, rows, mode="edge"), np.ones(rows) / rows, mode="same")
    speed = np.gradient(smooth[rows:-rows], old.time_s)
    sign = np.clip(speed / 0.3, -1.0, 1.0)
    return old.having(**{c: old.columns[c] + amplitude * sign for c in channels})


@of_channels
def outliers(
    _time_s: Floats, values: Floats, rng: np.random.Generator, *, share: float, size: float
) -> Floats:
    """Return a channel of which a share of the samples is off by about this much."""
    off = rng.random(values.size) < share
    sizes = size * rng.uniform(0.5, 1.5, off.size) * rng.choice((-1, 1), off.size)
    return np.asarray(values + off * sizes)


@of_channels
def bursts(
    time_s: Floats,
    values: Floats,
    rng: np.random.Generator,
    *,
    noise: float,
    lasts_s: float,
    times: int,
) -> Floats:
    """Return a channel with noise in short bursts."""
    at = rng.uniform(0.05, 0.9, times) * time_s[-1]
    inside = np.any([(time_s >= a) & (time_s < a + lasts_s) for a in at], axis=0)
    return np.asarray(values + inside * noise * rng.standard_normal(values.size))
