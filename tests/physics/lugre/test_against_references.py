"""The dynamic chain against the solutions of two general solvers of its equations."""

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks.lugre_rivals.references import FOLDER, problems
from tests.physics.lugre.lumps import run
from tests.physics.references import TABLE_1
from tsas_cli.physics.response import TOLERANCE
from tsas_cli.physics.rig import with_values

PROBLEMS = problems()
FINER = 20  # samples from one time of a reference to the next


def rig_of(model):
    """Return Table 1 of Yang 2025 with the friction of a reference's model."""
    values = {"viscous_friction.coefficient_N_s_per_mm": model.viscous_N_s_per_mm}
    if model.bristle_damping != "critical":
        values["bristles.damping_N_s_per_mm"] = model.whole_bristle_damping
    values["stribeck_friction.excess"] = model.stribeck_excess
    values["stribeck_friction.velocity_mm_per_s"] = model.stribeck_speed_mm_s
    return with_values(TABLE_1, values)


def apart(name, tolerance):
    """Return the largest difference of each channel from the reference, over its range."""
    problem, table = PROBLEMS[name], pq.read_table(FOLDER / f"{name}.parquet")
    finer = 1 if name.startswith("noisy") else FINER
    samples = np.arange(finer * (problem.time_s.size - 1) + 1)
    times = np.interp(samples, samples[::finer], problem.time_s)
    how = {"rig": rig_of(problem.model), "n": problem.model.lumps, "tolerance": tolerance}
    output, _ = run(problem.drive.position(times), times, **how)
    assert not np.any(output.phase == 3)
    off = {}
    for channel, row in (("x_out_mm", 1), ("f_in_N", 2), ("f_out_N", 3)):
        # Noise sets the drive off with a jump of its speed, which the reference feels at once.
        expected, found = table[channel].to_numpy()[1:], output[row][finer::finer]
        off[channel] = np.max(np.abs(found - expected)) / np.ptp(expected)
    return off


@pytest.mark.parametrize("name", PROBLEMS)
def test_at_its_tolerance_it_is_within_a_thousandth_of_the_range(name):
    """And within two of them where noise turns the drive 400 times a second."""
    off = apart(name, TOLERANCE)
    assert off["f_in_N"] < (2e-3 if name.startswith("noisy") else 1e-3)
    assert off["f_out_N"] < 1e-4
    assert off["x_out_mm"] < 1e-4


@pytest.mark.parametrize("name", [name for name in PROBLEMS if not name.startswith("noisy")])
def test_with_a_tight_one_it_is_the_reference(name):
    off = apart(name, 1e-7)
    assert off["f_in_N"] < 1e-4
    assert off["f_out_N"] < 1e-5
