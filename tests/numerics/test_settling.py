"""The drift against its definition: it starts at its rate and ends at rate/ν."""

import math

import numpy as np
import pytest

from tsas_cli.numerics.settling import exponential_drift


@pytest.mark.parametrize(
    ("settling_per_s", "time_s", "expected"),
    [
        (0.0, 7.0, 0.3 * 7.0),  # it goes on at its rate
        (1e-12, 20.0, 0.3 * 20.0),  # slow settling passes over into none
        (0.05, 20.0, 6.0 * (1.0 - math.exp(-1.0))),
        (0.05, 1e6, 0.3 / 0.05),
        *((each, 1e-6, 0.3e-6) for each in (0.0, 0.05, 100.0)),
    ],
)
def test_it_begins_at_its_rate_and_ends_at_the_rate_over_the_settling(
    settling_per_s, time_s, expected
):
    """At any time of a run, and of all its times at once."""
    times = np.array([0.0, time_s])
    found = exponential_drift(0.3, settling_per_s, times)
    assert found == pytest.approx([0.0, expected], rel=1e-4 if time_s == 1e-6 else 1e-10)
    for t, drift in zip(times, found, strict=True):
        assert exponential_drift(0.3, settling_per_s, t) == pytest.approx(drift, rel=1e-14)
        assert exponential_drift(0.0, settling_per_s, t) == 0.0
