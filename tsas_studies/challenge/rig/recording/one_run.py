"""One run is recorded otherwise than the others: a scale, a zero, a clock, or a part of it."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import of_channels


@of_channels
def run_gain(
    time_s: Floats,
    values: Floats,
    _rng: np.random.Generator,
    *,
    gain: float,
    since: float = 0.0,
) -> Floats:
    """Return a channel with another gain from this share of its time on."""
    return values * np.where(time_s >= since * time_s[-1], gain, 1.0)


@of_channels
def run_offset(
    time_s: Floats,
    values: Floats,
    _rng: np.random.Generator,
    *,
    offset: float,
    since: float = 0.0,
    until: float = 1.0,
) -> Floats:
    """Return a channel with another zero between two shares of its time."""
    share = time_s / time_s[-1]
    return np.asarray(values + offset * ((share >= since) & (share <= until)))


@of_channels
def run_clock(
    time_s: Floats,
    values: Floats,
    _rng: np.random.Generator,
    *,
    rate: float = 0.0,
    late_s: float = 0.0,
) -> Floats:
    """Return a channel by a clock of another pace, or later than others."""
    return np.interp(time_s * (1.0 + rate) - late_s, time_s, values)


@of_channels
def missed_counts(
    time_s: Floats, values: Floats, rng: np.random.Generator, *, lost_mm: float, times: int
) -> Floats:
    """Return an encoder that loses counts, some at each of several moments."""
    moments = np.sort(rng.uniform(0.15, 0.85, times)) * time_s[-1]
    return values - lost_mm / times * np.searchsorted(moments, time_s)
