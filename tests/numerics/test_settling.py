"""The drift against its definition: it starts at its rate and ends at rate/ν."""

import math

import numpy as np
import pytest

from tsas_cli.numerics.settling import exponential_drift


def test_without_settling_it_goes_on_at_its_rate():
    assert exponential_drift(0.3, 0.0, 7.0) == 0.3 * 7.0


def test_after_one_time_constant_it_is_63_percent_there():
    assert exponential_drift(0.3, 0.05, 20.0) == pytest.approx(0.3 / 0.05 * (1.0 - math.exp(-1.0)))


def test_it_ends_at_the_rate_over_the_settling():
    assert exponential_drift(0.3, 0.05, 1e6) == pytest.approx(6.0)


@pytest.mark.parametrize("settling_per_s", [0.0, 0.05, 100.0])
def test_it_begins_at_nothing_with_its_rate(settling_per_s):
    assert exponential_drift(0.3, settling_per_s, 0.0) == 0.0
    assert exponential_drift(0.3, settling_per_s, 1e-6) == pytest.approx(0.3e-6, rel=1e-4)


def test_slow_settling_passes_over_into_none():
    assert exponential_drift(0.3, 1e-12, 20.0) == pytest.approx(
        exponential_drift(0.3, 0.0, 20.0), rel=1e-10
    )


@pytest.mark.parametrize("settling_per_s", [0.0, 0.05])
def test_no_rate_is_no_drift_at_all(settling_per_s):
    assert exponential_drift(0.0, settling_per_s, 20.0) == 0.0


@pytest.mark.parametrize("settling_per_s", [0.0, 0.05])
def test_a_whole_run_at_once(settling_per_s):
    times = np.array([0.0, 3.0, 20.0])
    expected = [exponential_drift(0.3, settling_per_s, t) for t in times]
    np.testing.assert_allclose(exponential_drift(0.3, settling_per_s, times), expected, rtol=1e-14)
