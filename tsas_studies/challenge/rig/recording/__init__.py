"""Faults of recording: a sound rig moves, and what is written down of it is wrong.

Each fault is a function of all runs of a case, a stream of chance and its parameters.
"""

from collections.abc import Callable, Mapping

import numpy as np

from tsas_studies.challenge.rig.recording import (
    converter,
    filtered,
    one_run,
    pickup,
    timing,
    wrong_numbers,
)
from tsas_studies.challenge.rig.recording.recorded import STEPS, Runs
from tsas_studies.challenge.rig.sensors import quantised

_FUNCTIONS: tuple[Callable[..., Runs], ...] = (
    filtered.low_pass, filtered.zero_phase_low_pass, filtered.median, filtered.ac_coupled,
    filtered.held, one_run.run_gain, one_run.run_offset, one_run.run_clock, one_run.missed_counts,
    timing.lost_samples, timing.repeated_buffers, timing.jittered_stamps, timing.unsteady_sampling,
    timing.rounded_stamps, wrong_numbers.scaled, wrong_numbers.wrong_condition,
    converter.soft_saturation, converter.noisy_clipping, converter.sensor_hysteresis,
    converter.sensor_creep, converter.crosstalk, pickup.random_walk, pickup.hum,
    pickup.sign_interference, pickup.outliers, pickup.bursts,
)  # fmt: skip
FAULTS: Mapping[str, Callable[..., Runs]] = {one.__name__: one for one in _FUNCTIONS}


def recorded_with(
    runs: Runs, fault: str, parameters: Mapping[str, object], rng: np.random.Generator
) -> Runs:
    """Return the runs with a fault, each channel in the steps of its converter again."""
    return {
        name: run.having(**{c: quantised(run.columns[c], step) for c, step in STEPS.items()})
        for name, run in FAULTS[fault](runs, rng, **parameters).items()
    }
