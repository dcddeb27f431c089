"""The sheath's centre line in space, from all that is known of it: its length and its total bend.

It is drawn evenly bent. Up to a little over half a turn it lies flat, as an arc; beyond, its ends
or its turns would meet, and it rises as a helix of a gentle pitch, whose curvature adds up to the
same bend.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

FLAT_UP_TO_RAD = 1.2 * math.pi  # straight ends as long as the radius do not meet yet
RISE = 0.15  # of a helix, over the way along the ground


@dataclass(frozen=True)
class Shape:
    """The centre line, evenly spaced, shape (m + 1, 3) [mm], and the directions at both ends."""

    sheath: Floats
    into: Floats  # from the drive into the sheath, length 1, shape (3,)
    out_of: Floats  # out of the sheath towards the load

    def beside(self, distance_mm: float) -> Floats:
        """Return a curve beside the centre line, on its left (seen along it), shape (m + 1, 3)."""
        along = np.gradient(self.sheath, axis=0)
        left = np.cross([0.0, 0.0, 1.0], along)
        beside: Floats = self.sheath + distance_mm * left / np.linalg.norm(left, axis=1)[:, None]
        return beside

    def at(self, places: Floats) -> Floats:
        """Return points of the centre line at places from 0 to 1, shape (k, 3)."""
        known = np.linspace(0.0, 1.0, len(self.sheath))
        return np.column_stack([np.interp(places, known, axis) for axis in self.sheath.T])


def shape_of(length_mm: float, bend_rad: float, elements: int) -> Shape:
    """Return the shape, with its lowest point on the ground and its middle above the origin.

    Drive and load are at the near side (−y), the drive on the left, the arc behind them.
    """
    rise = math.atan(RISE) if bend_rad > FLAT_UP_TO_RAD else 0.0
    turn = bend_rad / math.cos(rise)  # of the heading: a helix bends by its cosine
    heading = turn * (0.5 - (np.arange(elements) + 0.5) / elements)
    chord = length_mm / elements * math.cos(rise) * np.sinc(0.5 * turn / elements / math.pi)
    steps = np.empty((elements, 3))
    steps[:, 0], steps[:, 1] = chord * np.cos(heading), chord * np.sin(heading)
    steps[:, 2] = length_mm / elements * math.sin(rise)
    sheath = np.vstack((np.zeros(3), np.cumsum(steps, axis=0)))
    middle = 0.5 * (sheath.min(axis=0) + sheath.max(axis=0))
    return Shape(
        sheath - [middle[0], middle[1], 0.0],
        _direction(turn / 2, rise),
        _direction(-turn / 2, rise),
    )


def _direction(heading: float, rise: float) -> Floats:
    flat = math.cos(rise)
    return np.array([flat * math.cos(heading), flat * math.sin(heading), math.sin(rise)])
