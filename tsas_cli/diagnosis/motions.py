"""Motions of the drive in planned runs: displacement [mm] over time [s], from 0 mm on."""

import math
from typing import Literal

import numpy as np

from tsas_cli.support.arrays import Floats

Kind = Literal["sine", "ramps", "steps", "nested", "chirp"]

# Ends of the strokes of a period, as shares of the longest one.
THERE_AND_BACK = (1.0, 0.0)
STAIRS = (0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.25, 0.0)
NESTED = (1.0, 0.3, 0.7, 0.4, 1.0, 0.0)
REVERSAL_S = 0.1  # in which a drive at constant speed reverses
SLOWEST = 0.1  # initial frequency of a chirp over its highest one
PEAK = {"sine": 2.0 * math.pi, "chirp": 2.0 * math.pi, "ramps": 4.0}  # speed / (A f)


def motion(
    kind: Kind,
    *,
    amplitude_mm: float,
    speed_mm_per_s: float,
    periods: int,
    dwell_s: float,
    rate_Hz: float,
) -> tuple[Floats, Floats]:
    """Return time [s] and displacement [mm] of a motion, shape (n,) each.

    Parameters
    ----------
    kind
        `sine`, A (1 − cos ωt); `ramps`, there and back at constant speed; `steps`, a staircase
        up and down; `nested`, loops within loops; `chirp`, a sine whose frequency rises tenfold.
    amplitude_mm
        Half of the stroke, which starts at 0 [mm].
    speed_mm_per_s
        The highest speed [mm/s].
    periods
        Number of cycles.
    dwell_s
        Rest after each stroke [s]; a chirp has none.
    rate_Hz
        Samples per second [1/s].
    """
    if kind == "chirp":
        highest = speed_mm_per_s / (PEAK[kind] * amplitude_mm)
        end = periods / (0.5 * (1.0 + SLOWEST) * highest)
        t = _clock(end, rate_Hz)
        cycles = highest * t * (SLOWEST + 0.5 * (1.0 - SLOWEST) * t / end)
        return t, amplitude_mm * (1.0 - np.cos(2.0 * math.pi * cycles))
    ends = {"steps": STAIRS, "nested": NESTED}.get(kind, THERE_AND_BACK)
    points = 2.0 * amplitude_mm * np.array((0.0, *(ends * periods)))
    rounded = kind in ("sine", "nested")
    strokes = np.diff(points)
    durations = np.abs(strokes) / speed_mm_per_s * (0.5 * math.pi if rounded else 1.0)
    starts = np.concatenate(([0.0], np.cumsum(durations + dwell_s)))
    t = _clock(starts[-1], rate_Hz)
    k = np.clip(np.searchsorted(starts, t, side="right") - 1, 0, strokes.size - 1)
    share = np.clip((t - starts[k]) / durations[k], 0.0, 1.0)
    if rounded:
        return t, points[k] + 0.5 * (1.0 - np.cos(math.pi * share)) * strokes[k]
    return t, _smoothed(points[k] + share * strokes[k], round(0.5 * REVERSAL_S * rate_Hz))


def _smoothed(x: Floats, reach: int) -> Floats:
    """Return the mean over `reach` samples before and after each one, the ends extended."""
    padded = np.pad(x, reach, mode="edge")
    return np.convolve(padded, np.full(2 * reach + 1, 1.0 / (2 * reach + 1)), mode="valid")


def _clock(duration_s: float, rate_Hz: float) -> Floats:
    return np.asarray(np.arange(math.floor(duration_s * rate_Hz + 1e-9) + 1) / rate_Hz)
