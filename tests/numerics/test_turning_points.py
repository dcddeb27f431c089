import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tsas_cli.numerics.turning_points import turning_points


def found(values, threshold):
    return turning_points(np.asarray(values, dtype=float), threshold).tolist()


SINE = 10 * np.sin(np.pi * np.arange(4001) / 1000 - np.pi / 2)  # turns at every full second


def test_the_extrema_of_a_sine_are_its_turning_points():
    assert found(SINE, 0.5) == found(-SINE, 0.5) == [0, 1000, 2000, 3000, 4000]
    turns = found(SINE + np.random.default_rng(3).uniform(-0.2, 0.2, SINE.size), 0.5)
    np.testing.assert_allclose(turns, [0, 1000, 2000, 3000, 4000], atol=80)


@pytest.mark.parametrize(
    ("values", "threshold", "expected"),
    [
        ([0, 5, 4, 8, 0], 0.9, [0, 1, 2, 3, 4]),  # a move back counts from the threshold on
        ([0, 5, 4, 8, 0], 1.0, [0, 3, 4]),
        ([0, 10, 4, 8, 6, 7, 2, 12], 0.5, [0, 1, 2, 3, 4, 5, 6, 7]),  # nested
        ([0, 10, 4, 8, 6, 7, 2, 12], 3.0, [0, 1, 2, 3, 6, 7]),
        ([0, 3, 3, 3, 0, 0, 3], 1, [0, 1, 4, 6]),  # of a flat extremum the first sample
        ([0, 0.5, -5, 5], 1, [0, 2, 3]),  # a small move before the first stroke
        ([1, 0, 3, 1], 2, [0, 3]),  # it ends where it began, and may be one stroke
        ([], 0.1, []),
        ([1], 0.1, [0]),
        ([1, 1], 0.1, [0, 1]),
        ([2] * 9, 0.1, [0, 8]),
    ],
)
def test_turning_points_of_short_signals(values, threshold, expected):
    assert found(values, threshold) == expected


@given(
    st.lists(st.integers(-100, 100), min_size=2, max_size=60),
    st.integers(1, 60),
)
def test_strokes_alternate_exceed_the_threshold_and_miss_nothing(values, threshold):
    turns = found(values, threshold)
    assert turns[0] == 0
    assert turns[-1] == len(values) - 1
    strokes = np.diff(np.asarray(values)[turns])
    inner = strokes[1:-1]
    assert (np.abs(inner) > threshold).all()
    if len(strokes) > 1:
        assert (strokes[1:] * strokes[:-1] < 0).all()
    for start, end, stroke in zip(turns, turns[1:], strokes, strict=False):
        piece = np.asarray(values[start : end + 1])
        back = [(np.maximum.accumulate(way) - way).max() for way in (piece, -piece)]
        only = len(strokes) == 1  # where it ends does not tell which way it went
        falls_back = min(back) if only else back[0 if stroke > 0 else 1]
        assert falls_back <= threshold
