"""The centre line has the length and the bend that are known, and keeps clear of itself."""

import math

import numpy as np
import pytest

from tsas_cli.reporting.stream.tendon.shape import FLAT_UP_TO_RAD, shape_of

BENDS = [0.0, 0.3, math.pi / 2, math.pi, FLAT_UP_TO_RAD, 1.5 * math.pi, 2 * math.pi, 7 * math.pi]


@pytest.mark.parametrize("bend", BENDS)
def test_length_and_total_bend(bend):
    shape = shape_of(785.0, bend, 400)
    steps = np.diff(shape.sheath, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    assert lengths.sum() == pytest.approx(785.0, rel=1e-3)
    np.testing.assert_allclose(lengths, lengths[0], rtol=1e-9)
    along = np.vstack((shape.into, steps / lengths[:, None], shape.out_of))
    turned = np.arccos(np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0))
    assert turned.sum() == pytest.approx(bend, rel=1e-3, abs=1e-5)


@pytest.mark.parametrize("bend", BENDS)
def test_no_place_comes_near_another_turn(bend):
    shape = shape_of(785.0, bend, 400)
    apart = np.linalg.norm(shape.sheath[:, None] - shape.sheath[None], axis=2)
    places = np.arange(401)
    far_along = np.abs(places[:, None] - places[None]) * 785.0 / 400 > 100.0
    radius = 785.0 / max(bend, 1.0)
    assert apart[far_along].min() > min(0.8 * radius, 60.0)


def test_straight_lies_on_a_line_from_drive_to_load():
    shape = shape_of(500.0, 0.0, 10)
    np.testing.assert_allclose(shape.sheath[:, 0], np.linspace(-250.0, 250.0, 11))
    np.testing.assert_allclose(shape.sheath[:, 1:], 0.0, atol=1e-9)
    np.testing.assert_allclose(shape.into, [1.0, 0.0, 0.0])


def test_half_a_turn_has_drive_left_load_right_and_the_arc_behind():
    shape = shape_of(250.0 * math.pi, math.pi, 200)
    drive, load = shape.sheath[0], shape.sheath[-1]
    assert load[0] - drive[0] == pytest.approx(500.0, rel=1e-3)
    np.testing.assert_allclose(shape.into, [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(shape.out_of, [0.0, -1.0, 0.0], atol=1e-12)
    assert np.ptp(shape.sheath[:, 1]) == pytest.approx(250.0, rel=1e-3)
    assert np.ptp(shape.sheath[:, 2]) == 0.0


def test_places_and_what_is_beside():
    shape = shape_of(250.0 * math.pi, math.pi, 200)
    np.testing.assert_allclose(shape.at(np.array([0.0, 1.0])), shape.sheath[[0, -1]])
    np.testing.assert_allclose(shape.at(np.array([0.5]))[0], shape.sheath[100])
    outside, inside = shape.beside(10.0), shape.beside(-10.0)  # the arc bends to the right
    assert np.ptp(outside[:, 0]) == pytest.approx(520.0, rel=1e-2)
    assert np.ptp(inside[:, 0]) == pytest.approx(480.0, rel=1e-2)
