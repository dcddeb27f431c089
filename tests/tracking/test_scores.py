"""Scores against numbers worked out by hand."""

import math

import numpy as np
import pytest

from tsas_cli.tracking.track import over_seeds, score

WANTED = np.array([30.0, 40.0, 50.0, 40.0])
ACTUAL = np.array([30.3, 39.0, 50.0, 42.0])
ASKED = np.array([100.0, -100.0, 50.0, 50.0])


def test_every_number_of_a_run():
    """Errors −0.3, 1, 0, −2 of a range of 20: two beyond 0.4."""
    one = score(WANTED, ACTUAL, ASKED, 0.5, 100.0)
    assert one.rmse_N == pytest.approx(math.sqrt((0.09 + 1.0 + 4.0) / 4.0))
    assert (one.lowest_error_N, one.highest_error_N) == pytest.approx((-2.0, 1.0))
    assert one.effort_rpm == pytest.approx(math.sqrt((1e4 + 1e4 + 2500.0 + 2500.0) / 4.0))
    assert one.chatter_rpm_per_s == pytest.approx((200.0 + 150.0) / 2.0)
    assert (one.outside_percent, one.at_limit_percent) == (50.0, 50.0)


def test_a_perfect_run_is_all_zeros():
    one = score(WANTED, WANTED, np.zeros(4), 0.5, 100.0)
    assert set(vars(one).values()) == {0.0}


def test_over_seeds_are_mean_and_sample_deviation():
    runs = [score(WANTED, WANTED + off, ASKED, 0.5, 100.0) for off in (1.0, 2.0, 4.5)]
    rmse = over_seeds(runs).rmse_N
    assert rmse.mean == pytest.approx(2.5)
    assert rmse.sd == pytest.approx(math.sqrt((1.5**2 + 0.5**2 + 2.0**2) / 2.0))
    assert over_seeds(runs).effort_rpm.sd == 0.0


def test_one_seed_has_no_spread():
    assert over_seeds([score(WANTED, ACTUAL, ASKED, 0.5, 100.0)]).rmse_N.sd is None
