"""The noise of x_in is told of short runs too, and of those laid on a faster clock."""

import numpy as np
import pytest

from tsas_cli.drive.runs import drive_runs
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording

NOISE_MM = 0.005


def recording(samples, times=1):
    """Return a run of so many recorded samples, laid on a clock so many times as fast."""
    time_s = np.arange(samples) / 200.0
    x_in = 5.0 * np.sin(2.0 * time_s) + NOISE_MM * np.random.default_rng(1).standard_normal(samples)
    clock = np.linspace(0.0, time_s[-1], times * (samples - 1) + 1)
    columns = {
        "time_s": clock,
        "motor_speed_rpm": 400.0 * np.cos(2.0 * clock),
        "x_in_mm": np.interp(clock, time_s, x_in),
    }
    return Recording(Run(id="a", file="runs/a.parquet", sha256="0" * 64), columns)


@pytest.mark.parametrize(("samples", "times"), [(500, 1), (620, 1), (4000, 1), (500, 2), (2000, 3)])
def test_the_noise_of_x_in_is_that_of_its_sensor(samples, times):
    (run,) = drive_runs([recording(samples, times)], "zero")
    assert run.noise_mm == pytest.approx(NOISE_MM, rel=0.2)
