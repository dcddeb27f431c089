import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tsas_cli.numerics.turning_points import turning_points


def found(values: object, threshold: float) -> list[int]:
    return turning_points(np.asarray(values, dtype=float), threshold).tolist()


def test_the_extrema_of_a_sine_are_its_turning_points() -> None:
    time_s = np.arange(4001) / 1000
    values = 10 * np.sin(np.pi * time_s - np.pi / 2)  # turns at every full second
    assert found(values, 0.5) == [0, 1000, 2000, 3000, 4000]
    assert found(-values, 0.5) == [0, 1000, 2000, 3000, 4000]


def test_noise_below_the_threshold_adds_no_turn() -> None:
    time_s = np.arange(4001) / 1000
    rng = np.random.default_rng(3)
    values = 10 * np.sin(np.pi * time_s - np.pi / 2) + rng.uniform(-0.2, 0.2, time_s.size)
    turns = found(values, 0.5)
    assert len(turns) == 5
    np.testing.assert_allclose(turns, [0, 1000, 2000, 3000, 4000], atol=80)


def test_a_move_back_counts_from_the_threshold_on() -> None:
    values = [0, 5, 4, 8, 0]
    assert found(values, 0.9) == [0, 1, 2, 3, 4]
    assert found(values, 1.0) == [0, 3, 4]


def test_nested_reversals_are_all_found() -> None:
    assert found([0, 10, 4, 8, 6, 7, 2, 12], 0.5) == [0, 1, 2, 3, 4, 5, 6, 7]
    assert found([0, 10, 4, 8, 6, 7, 2, 12], 3.0) == [0, 1, 2, 3, 6, 7]


def test_of_a_flat_extremum_the_first_sample_is_taken() -> None:
    assert found([0, 3, 3, 3, 0, 0, 3], 1) == [0, 1, 4, 6]


def test_a_small_move_before_the_first_stroke_is_no_turn() -> None:
    assert found([0, 0.5, -5, 5], 1) == [0, 2, 3]


@pytest.mark.parametrize(
    ("values", "expected"), [([], []), ([1], [0]), ([1, 1], [0, 1]), ([2] * 9, [0, 8])]
)
def test_a_signal_that_does_not_move_is_one_stroke(
    values: list[float], expected: list[int]
) -> None:
    assert found(values, 0.1) == expected


@given(
    st.lists(st.integers(-100, 100), min_size=2, max_size=60),
    st.integers(1, 60),
)
def test_strokes_alternate_exceed_the_threshold_and_miss_nothing(
    values: list[int], threshold: int
) -> None:
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


def test_a_signal_that_ends_where_it_began_may_be_one_stroke() -> None:
    assert found([1, 0, 3, 1], 2) == [0, 3]
