"""Colours of tensions."""

import numpy as np

from tsas_cli.reporting.stream.tendon.shades import dimmed, packed, scale_of

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def test_more_tension_is_brighter():
    scale = scale_of(17.0, 82.0)
    light = scale.colours(np.linspace(17.0, 82.0, 40)) @ LUMINANCE
    assert (np.diff(light) > 0.0).all()
    assert light[-1] > 3.0 * light[0]
    np.testing.assert_array_equal(
        scale.colours(np.array([-5.0, 17.0, 82.0, 900.0])),
        scale.colours(np.array([17.0, 17.0, 82.0, 82.0])),
    )
    assert scale.colours(np.full((3, 4), 30.0)).shape == (3, 4, 3)
    assert scale.colours(np.array([np.nan])).shape == (1, 3)


def test_ticks_are_round_and_within():
    assert scale_of(17.0, 82.0).ticks == (20.0, 40.0, 60.0, 80.0)
    assert scale_of(0.0, 1.0).ticks == (0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0)
    alone = scale_of(25.0, 25.0)
    assert alone.high > alone.low
    assert alone.colours(np.array([25.0])).shape == (1, 3)


def test_packing_and_dimming():
    assert packed(np.array([[1, 2, 3]], dtype=np.uint8))[0] == 0x010203FF
    half = dimmed(np.array([[100, 200, 0]], dtype=np.uint8), 0.5, 0x0A1400FF)
    np.testing.assert_array_equal(half, [[55, 110, 0]])
