"""All tendons of a scene are seen, at the same size, above each other."""

import math

import numpy as np
import pytest

from tests.physics.references import FREE, GROUP_A
from tsas_cli.reporting.stream.tendon.stage import TALL, stage_of

BENDS = [0.0, math.pi / 2, math.pi, 2 * math.pi, 5 * math.pi]


def seen_by(stage, points):
    """Project points as an eye does: right and up, over the distance ahead."""
    eye, target = np.array(stage.eye), np.array(stage.target)
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    relative = points - eye
    return np.stack((relative @ right, relative @ up), axis=1) / (relative @ ahead)[:, None]


@pytest.mark.parametrize("bend", BENDS)
@pytest.mark.parametrize("rigs", [(GROUP_A,), (GROUP_A, FREE)])
def test_everything_is_in_the_picture(bend, rigs):
    stage = stage_of([rig._replace(total_bend_rad=bend) for rig in rigs], 60)
    places = []
    for stand in stage.stands:
        above = stand.sheath + TALL * stand.size * np.array([0.0, 0.0, 1.0])
        ends = np.concatenate((stand.ends.rim, stand.ends.anchor)) + stand.at
        seen = seen_by(stage, np.concatenate((stand.sheath, above, ends, stand.captions)))
        # A usual view is 55 degrees high and a little wider: ±0.52 upwards, ±0.6 across.
        assert np.abs(seen[:, 1]).max() < 0.50
        assert np.abs(seen[:, 0]).max() < 0.56
        places.append((seen[:, 1].min(), seen[:, 1].max(), seen[:, 0].max()))
    fills = max(places[0][1] / 0.47, -places[-1][0] / 0.47, max(p[2] for p in places) / 0.54)
    assert fills > 0.9
    if len(places) == 2:
        assert places[0][0] > places[1][1] - 0.03  # the first above the second


def test_the_same_place_is_at_the_same_place_across():
    stage = stage_of([GROUP_A, FREE], 60)
    one, other = (seen_by(stage, stand.sheath) for stand in stage.stands)
    np.testing.assert_allclose(one[:, 0], other[:, 0], atol=0.06)
    away = [np.linalg.norm(stand.at - np.array(stage.eye)) for stand in stage.stands]
    assert away[0] == pytest.approx(away[1], rel=0.05)
    assert stage.stands[0].size == stage.stands[1].size
