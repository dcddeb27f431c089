"""Glyphs at the ends: the pulley winds up what the drive takes, the spring stretches with it."""

import math

import numpy as np
import pytest

from tsas_cli.reporting.stream.tendon.ends import RADIUS, ends_of
from tsas_cli.reporting.stream.tendon.shape import shape_of

SIZE = 500.0
SHAPE = shape_of(250.0 * math.pi, math.pi, 60)
ENDS = ends_of(SHAPE, (150.0, 60.0), SIZE)


def test_free_lengths_are_drawn_as_they_are():
    none = ends_of(SHAPE, (0.0, 0.0), SIZE)
    lengths = [np.linalg.norm(np.diff(ends.proximal, axis=0)) for ends in (none, ENDS)]
    assert lengths[1] - lengths[0] == pytest.approx(150.0)
    distal = [np.linalg.norm(np.diff(e.distal(np.zeros(1))[0], axis=0)) for e in (none, ENDS)]
    assert distal[1] - distal[0] == pytest.approx(60.0)
    np.testing.assert_allclose(ENDS.proximal[1], SHAPE.sheath[0])
    np.testing.assert_allclose(ENDS.distal(np.zeros(3))[:, 0], np.tile(SHAPE.sheath[-1], (3, 1)))


def test_the_pulley_moves_with_the_tendon_that_it_winds_up():
    spokes = ENDS.spokes(np.array([0.0, 1.0]))
    first = spokes[:, 0, 1]  # the one that points to where the tendon touches
    np.testing.assert_allclose(first[0], ENDS.proximal[0], atol=1e-9)
    way = first[1] - first[0]
    assert way @ -SHAPE.into == pytest.approx(1.0, rel=1e-3)  # pulled out of the sheath
    np.testing.assert_allclose(np.linalg.norm(spokes[:, :, 1] - spokes[:, :, 0], axis=2), 35.0)
    around = np.linalg.norm(ENDS.rim - ENDS.centre, axis=1)
    np.testing.assert_allclose(around, RADIUS * SIZE)


def test_the_spring_stretches_by_what_the_load_moves():
    x_out = np.array([0.0, 16.0])
    spring = ENDS.spring(x_out)
    lengths = np.linalg.norm(spring[:, -1] - spring[:, 0], axis=1)
    assert lengths[1] - lengths[0] == pytest.approx(16.0)
    np.testing.assert_allclose(spring[:, -1], np.tile(ENDS.anchor.mean(axis=0), (2, 1)))
    np.testing.assert_allclose(spring[:, 0], ENDS.distal(x_out)[:, 1])


def test_a_load_that_moves_far_stays_out_of_the_sheath():
    tips = ENDS.distal(np.array([0.0, 500.0]))[:, 1]
    np.testing.assert_allclose(tips[1], SHAPE.sheath[-1], atol=1e-9)
