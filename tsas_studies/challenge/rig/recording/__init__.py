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
from tsas_studies.challenge.rig.recording.recorded import STEPS, RecordedRun, Runs
from tsas_studies.challenge.rig.sensors import quantised

FAULTS: Mapping[str, Callable[..., Runs]] = {
    "low_pass": filtered.low_pass,
    "zero_phase_low_pass": filtered.zero_phase_low_pass,
    "median": filtered.median,
    "ac_coupled": filtered.ac_coupled,
    "held": filtered.held,
    "run_gain": one_run.run_gain,
    "run_offset": one_run.run_offset,
    "run_clock": one_run.run_clock,
    "missed_counts": one_run.missed_counts,
    "lost_samples": timing.lost_samples,
    "repeated_buffers": timing.repeated_buffers,
    "jittered_stamps": timing.jittered_stamps,
    "unsteady_sampling": timing.unsteady_sampling,
    "rounded_stamps": timing.rounded_stamps,
    "scaled": wrong_numbers.scaled,
    "wrong_condition": wrong_numbers.wrong_condition,
    "soft_saturation": converter.soft_saturation,
    "noisy_clipping": converter.noisy_clipping,
    "sensor_hysteresis": converter.sensor_hysteresis,
    "sensor_creep": converter.sensor_creep,
    "crosstalk": converter.crosstalk,
    "random_walk": pickup.random_walk,
    "hum": pickup.hum,
    "sign_interference": pickup.sign_interference,
    "outliers": pickup.outliers,
    "bursts": pickup.bursts,
}


def recorded_with(
    runs: Runs, fault: str, parameters: Mapping[str, object], rng: np.random.Generator
) -> Runs:
    """Return the runs with a fault, each channel in the steps of its converter again."""
    return {name: _in_steps(run) for name, run in FAULTS[fault](runs, rng, **parameters).items()}


def _in_steps(run: RecordedRun) -> RecordedRun:
    return run.having(**{c: quantised(run.columns[c], step) for c, step in STEPS.items()})
