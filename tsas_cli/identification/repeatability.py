"""The repeatability of a channel: its scatter between strokes of the same motion.

Strokes are compared at the same travel since their reversal, pulling and releasing apart; x_out
counts from the reversal of x_in. No model that is driven by the same motion predicts better.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.fitted_to import FittedTo, departures
from tsas_cli.identification.prepared import Prepared
from tsas_cli.support.arrays import Floats

POINTS = 100  # of a stroke
SAME_END = 0.02  # of a stroke: its ends, in strokes of the same motion
SAME_DURATION = 0.1
FEWEST_SAMPLES = 20  # of a stroke
AVERAGED = 1.0 / 3.0  # of the variance of white noise, between two samples: ∫ 1 − w² − (1 − w)² dw


@dataclass(frozen=True)
class StrokeAtTravel:
    """One stroke: its ends [mm], its duration [s]; each channel's travels [mm] and values."""

    start_mm: float
    end_mm: float
    duration_s: float
    channels: Mapping[str, tuple[Floats, Floats]]

    def repeats(self, other: "StrokeAtTravel") -> bool:
        """Say whether it is the same motion as another stroke."""
        room = SAME_END * abs(other.end_mm - other.start_mm)
        return (
            abs(self.start_mm - other.start_mm) <= room
            and abs(self.end_mm - other.end_mm) <= room
            and abs(self.duration_s - other.duration_s) <= SAME_DURATION * other.duration_s
        )


def repeatability(
    runs: Sequence[Prepared], ranges: Sequence[FittedTo]
) -> list[dict[str, float | None]]:
    """Return the repeatability of each run's channels, in their units; None where nothing repeats.

    Strokes within a run are compared, and where none repeats there, those of runs of the same
    conditions and signals, by their `ranges`, too.
    """
    strokes = [_strokes(run) for run in runs]
    out = []
    for run, own, here in zip(runs, strokes, ranges, strict=True):
        alike = [
            stroke
            for others, there in zip(strokes, ranges, strict=True)
            if not departures(here, there) and not departures(there, here)
            for stroke in others
        ]
        out.append(
            {
                name: _scatter(own, own, name, noise) or _scatter(own, alike, name, noise)
                for name, noise in run.noise.items()
            }
        )
    return out


def _scatter(
    own: Sequence[StrokeAtTravel], strokes: Sequence[StrokeAtTravel], channel: str, noise: float
) -> float | None:
    """Return the standard deviation between the strokes that repeat one of a run's own."""
    squares, freedom = 0.0, 0
    for pulling in (True, False):
        way = [s for s in own if (s.end_mm > s.start_mm) is pulling and channel in s.channels]
        if not way:
            continue
        first = max(way, key=lambda stroke: sum(other.repeats(stroke) for other in way))
        at = (np.arange(POINTS) + 0.5) / POINTS * abs(first.end_mm - first.start_mm)
        same = [
            np.interp(at, *s.channels[channel])
            for s in strokes
            if channel in s.channels and s.repeats(first)
        ]
        if len(same) > 1:
            squares += float(np.sum((np.array(same) - np.mean(same, axis=0)) ** 2))
            freedom += (len(same) - 1) * POINTS
    averaged = 0.0 if math.isnan(noise) else AVERAGED * noise**2
    return math.sqrt(squares / freedom + averaged) if freedom else None


def _strokes(run: Prepared) -> list[StrokeAtTravel]:
    """Return the strokes of a run that is driven by displacement, but for the first, from rest."""
    if run.drive_column != "x_in_mm":
        return []
    x_in = run.conditioned["x_in_mm"]
    out = []
    for start, end in zip(x_in.reversals[1:-1], x_in.reversals[2:], strict=True):
        rows = slice(int(start), int(end) + 1)
        x_mm, time_s = x_in.values[rows], run.time_s[rows]
        channels = {}
        for name, values in run.measured.items():
            finite = np.isfinite(values[rows])
            if np.count_nonzero(finite) >= FEWEST_SAMPLES:
                from_mm = x_mm[0] if name == "x_out_mm" else 0.0
                travel_mm = np.abs(x_mm - x_mm[0])[finite]
                channels[name] = (travel_mm, values[rows][finite] - from_mm)
        if not run.in_gap[rows].any():
            duration_s = float(time_s[-1] - time_s[0])
            out.append(StrokeAtTravel(float(x_mm[0]), float(x_mm[-1]), duration_s, channels))
    return out
