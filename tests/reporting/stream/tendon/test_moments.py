"""When a tendon is looked at."""

import numpy as np

from tsas_cli.reporting.stream.tendon.followed import MOST, PER_SECOND, PER_SPAN, moments

TIME_S = np.arange(0.0, 10.0, 1e-3)
NONE = np.array([], dtype=np.int64)


def test_evenly_where_nothing_changes():
    at = moments(TIME_S, [np.full(TIME_S.size, 25.0)], NONE)
    assert at[0] == 0
    assert at[-1] == TIME_S.size - 1
    assert abs(at.size - 10.0 * PER_SECOND) < 3
    assert np.ptp(np.diff(at)[:-1]) <= 1


def test_densely_where_a_tension_falls():
    tension = np.interp(TIME_S, [0.0, 5.0, 5.2, 10.0], [60.0, 60.0, 20.0, 20.0])
    at = moments(TIME_S, [np.zeros(TIME_S.size), tension], NONE)
    assert np.abs(np.diff(tension[at])).max() < 1.5 * 40.0 / PER_SPAN
    assert np.count_nonzero((TIME_S[at] > 5.0) & (TIME_S[at] < 5.2)) > 0.9 * PER_SPAN


def test_turns_are_among_them_and_gaps_do_no_harm():
    tension = np.where(TIME_S < 3.0, np.nan, 25.0 + TIME_S)
    at = moments(TIME_S, [tension], np.array([1234, 7777]))
    assert {1234, 7777} <= set(at.tolist())
    assert (np.diff(at) > 0).all()


def test_a_long_run_has_no_more_than_a_limit():
    time_s = np.linspace(0.0, 4000.0, 200_000)
    assert moments(time_s, [np.sin(time_s)], NONE).size <= MOST + 2
    turns = np.arange(0, time_s.size, 10)
    assert moments(time_s, [np.full(time_s.size, np.nan)], turns).size <= 2 * MOST + 2
