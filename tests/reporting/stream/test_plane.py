import numpy as np
import pytest

from tsas_cli.reporting.stream.plane import HEIGHT, WIDTH, frame_of


def test_what_is_larger_stands_further_right_and_further_up():
    """Up is towards smaller y in the viewer's plane."""
    x, y = np.array([0.0, 20.0]), np.array([17.0, 83.0])
    (left, bottom), (right, top) = frame_of(x, y).place(x, y)
    assert 0.0 < left < right < WIDTH
    assert 0.0 > bottom > top > -HEIGHT


def test_ticks_are_round_numbers_within_the_range():
    frame = frame_of(np.array([0.0, 20.0]), np.array([17.0, 83.0]))
    assert frame.x.ticks() == [0.0, 5.0, 10.0, 15.0, 20.0]
    assert frame.y.ticks() == [20.0, 40.0, 60.0, 80.0]


@pytest.mark.parametrize("value", [0.0, -3.0, 1e-9, 1e12])
def test_a_point_alone_has_axes_too(value):
    frame = frame_of(np.array([value]), np.array([5.0]))
    assert np.isfinite(frame.place(np.array([value]), np.array([5.0]))).all()
    assert all(np.isfinite(line).all() for line in frame.lines())


def test_texts_stand_at_their_ticks():
    frame = frame_of(np.array([0.0, 20.0]), np.array([17.0, 83.0]))
    places, texts = frame.texts("x [mm]", "F [N]")
    assert texts == ["0", "5", "10", "15", "20", "20", "40", "60", "80", "x [mm]", "F [N]"]
    assert places[4, 0] == frame.x.place(np.array(20.0))
    assert places.shape == (11, 2)
