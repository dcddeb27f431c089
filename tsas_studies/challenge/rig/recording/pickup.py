"""What is added to a channel on its way: hum, noise, interference, values that are none."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import Runs, changed
from tsas_studies.challenge.rig.recordings import Run


def random_walk(
    runs: Runs, rng: np.random.Generator, *, channels: tuple[str, ...], per_root_s: float
) -> Runs:
    """Return channels whose zero wanders."""

    def walked(time_s: Floats, values: Floats) -> Floats:
        steps = np.sqrt(time_s[1] - time_s[0]) * rng.standard_normal(values.size)
        return values + per_root_s * np.cumsum(steps)

    return changed(runs, channels, walked)


def hum(
    runs: Runs,
    rng: np.random.Generator,
    *,
    channels: tuple[str, ...],
    amplitude: float,
    frequency_Hz: float,
) -> Runs:
    """Return channels with a sine of one frequency, its phase drawn for each run."""

    def hummed(time_s: Floats, values: Floats) -> Floats:
        phase = rng.uniform(0.0, 2.0 * np.pi)
        return values + amplitude * np.sin(2.0 * np.pi * frequency_Hz * time_s + phase)

    return changed(runs, channels, hummed)


def sign_interference(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], amplitude: float
) -> Runs:
    """Return channels that take up the direction in which the motor turns."""

    def taken_up(old: Run) -> Run:
        x = old.columns["x_in_mm"]
        rows = max(round(0.1 / (old.time_s[1] - old.time_s[0])), 3)
        smooth = np.convolve(np.pad(x, rows, mode="edge"), np.ones(rows) / rows, mode="same")
        speed = np.gradient(smooth[rows:-rows], old.time_s)
        sign = np.clip(speed / 0.3, -1.0, 1.0)
        return old.having(**{c: old.columns[c] + amplitude * sign for c in channels})

    return {name: taken_up(old) for name, old in runs.items()}


def outliers(
    runs: Runs, rng: np.random.Generator, *, channels: tuple[str, ...], share: float, size: float
) -> Runs:
    """Return channels of which a share of the samples is off by about this much."""

    def spoiled(_time_s: Floats, values: Floats) -> Floats:
        off = rng.random(values.size) < share
        sizes = size * rng.uniform(0.5, 1.5, off.size) * rng.choice((-1, 1), off.size)
        return np.asarray(values + off * sizes)

    return changed(runs, channels, spoiled)


def bursts(
    runs: Runs,
    rng: np.random.Generator,
    *,
    channels: tuple[str, ...],
    noise: float,
    lasts_s: float,
    times: int,
) -> Runs:
    """Return channels with noise in short bursts."""

    def noisy(time_s: Floats, values: Floats) -> Floats:
        at = rng.uniform(0.05, 0.9, times) * time_s[-1]
        inside = np.any([(time_s >= a) & (time_s < a + lasts_s) for a in at], axis=0)
        return np.asarray(values + inside * noise * rng.standard_normal(values.size))

    return changed(runs, channels, noisy)
