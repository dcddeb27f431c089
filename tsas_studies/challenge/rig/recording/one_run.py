"""One run is recorded otherwise than the others: a scale, a zero, a clock, or a part of it."""

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import Runs, changed


def run_gain(
    runs: Runs,
    _rng: np.random.Generator,
    *,
    run: str,
    channel: str,
    gain: float,
    since: float = 0.0,
) -> Runs:
    """Return a channel with another gain in one run, from this share of its time on."""
    return changed(runs, (channel,), lambda t, v: v * np.where(t >= since * t[-1], gain, 1.0), run)


def run_offset(
    runs: Runs,
    _rng: np.random.Generator,
    *,
    run: str,
    channel: str,
    offset: float,
    since: float = 0.0,
    until: float = 1.0,
) -> Runs:
    """Return a channel with another zero in one run, between two shares of its time."""

    def moved(time_s: Floats, values: Floats) -> Floats:
        share = time_s / time_s[-1]
        return np.asarray(values + offset * ((share >= since) & (share <= until)))

    return changed(runs, (channel,), moved, run)


def run_clock(
    runs: Runs,
    _rng: np.random.Generator,
    *,
    run: str | None,
    channels: tuple[str, ...],
    rate: float = 0.0,
    late_s: float = 0.0,
) -> Runs:
    """Return channels of one run, or all, by a clock of another pace, or later than others."""
    return changed(runs, channels, lambda t, v: np.interp(t * (1.0 + rate) - late_s, t, v), run)


def missed_counts(
    runs: Runs, rng: np.random.Generator, *, run: str, channel: str, lost_mm: float, times: int
) -> Runs:
    """Return an encoder that loses counts, some at each of several moments."""

    def lost(time_s: Floats, values: Floats) -> Floats:
        moments = np.sort(rng.uniform(0.15, 0.85, times)) * time_s[-1]
        return values - lost_mm / times * np.searchsorted(moments, time_s)

    return changed(runs, (channel,), lost, run)
