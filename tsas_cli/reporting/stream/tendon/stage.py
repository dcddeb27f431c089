"""Where tendons stand in a scene, and the eye that sees them all at the same size.

They stand above each other as the eye sees it, each as far from it as the others: what is at the
same place of the sheath is at the same place across the picture.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.physics.rig import Rig
from tsas_cli.reporting.stream.tendon.ends import Ends, ends_of
from tsas_cli.reporting.stream.tendon.shape import Shape, shape_of

Floats = npt.NDArray[np.float64]

DOWN_RAD = math.radians(44.0)  # by which the eye looks down
SEEN = (0.54, 0.47)  # half of what is filled across and upwards, at distance 1
FITS = 12  # steps towards that
TALL = 0.36  # of the scene's size: how high the highest tension is drawn
GAP = 0.08  # of the size, between two tendons
LEFT = 0.16  # of the size, kept free for the legend
_RIGHT = np.array([1.0, 0.0, 0.0])
_UP = np.array([0.0, math.sin(DOWN_RAD), math.cos(DOWN_RAD)])
_BACK = np.array([0.0, -math.cos(DOWN_RAD), math.sin(DOWN_RAD)])


@dataclass(frozen=True)
class Stand:
    """One tendon in the scene; `at` is where its shape's origin is, `size` the scene's [mm]."""

    shape: Shape
    ends: Ends
    at: Floats
    size: float

    @property
    def sheath(self) -> Floats:
        """The centre line in the scene, shape (m + 1, 3)."""
        return self.shape.sheath + self.at

    @property
    def captions(self) -> Floats:
        """Where two lines of text stand, shape (2, 3)."""
        return _captions(self.shape, self.size) + self.at


@dataclass(frozen=True)
class Stage:
    """The stands, and the eye with what it looks at."""

    stands: list[Stand]
    eye: Floats
    target: Floats


def stage_of(rigs: Sequence[Rig], elements: int) -> Stage:
    """Return where tendons stand, their centre lines in so many pieces."""
    shapes = [shape_of(rig.sheath_length_mm, rig.total_bend_rad, elements) for rig in rigs]
    size = max(float(np.ptp(shape.sheath, axis=0).max()) for shape in shapes)
    ends = [
        ends_of(shape, (free.proximal_length_mm, free.distal_length_mm), size)
        for shape, free in zip(shapes, (rig.effects.free_tendon for rig in rigs), strict=True)
    ]
    shown = [_shown(shape, end, size) for shape, end in zip(shapes, ends, strict=True)]
    heights = np.concatenate(shown) @ _UP
    step = float(np.ptp(heights)) + GAP * size
    places = [step * (0.5 * (len(shapes) - 1) - k) * _UP for k in range(len(shapes))]
    stands = [Stand(*parts, size) for parts in zip(shapes, ends, places, strict=True)]
    everything = [points + at for points, at in zip(shown, places, strict=True)]
    return Stage(stands, *_eye(np.concatenate(everything), 2.0 * size))


def _eye(points: Floats, away: float) -> tuple[Floats, Floats]:
    """Return from where points fill a view, and where to look; `away` is a first guess."""
    target = np.zeros(3)
    for _ in range(FITS):
        relative = points - target
        ahead = away - relative @ _BACK
        seen = np.stack((relative @ _RIGHT, relative @ _UP)) / ahead
        low, high = seen.min(axis=1), seen.max(axis=1)
        across, up = 0.5 * away * (low + high)
        target = target + across * _RIGHT + up * _UP
        away *= float(np.max(0.5 * (high - low) / SEEN))
    return target + away * _BACK, target


def _captions(shape: Shape, size: float) -> Floats:
    """Return where two lines of text stand: within an arc, else before it."""
    near, deep = shape.sheath[:, 1].min(), np.ptp(shape.sheath[:, 1])
    coiled = bool(np.ptp(shape.sheath[:, 2]) > 0.0)
    inside = 0.0 if coiled else min(1.0, 2.0 * deep / size)  # where there is room
    first = near + (0.2 * inside - (0.25 if coiled else 0.12)) * size
    return np.array([[0.0, first, 0.0], [0.0, first - 0.1 * size, 0.0]])


def _shown(shape: Shape, ends: Ends, size: float) -> Floats:
    """Return points around all that is drawn of a tendon, the legend and its texts among it."""
    above = shape.sheath + TALL * size * np.array([0.0, 0.0, 1.0])
    below = _captions(shape, size) - [0.0, 0.05 * size, 0.0]
    beside = shape.sheath.min(axis=0) * [1.0, 0.0, 0.0] - [LEFT * size, 0.0, 0.0]
    named = ends.names
    return np.concatenate((shape.sheath, above, ends.rim, ends.anchor, named, below, beside[None]))
