"""What is drawn at the ends of the sheath: free tendon, the drive's pulley, the load's spring.

Lengths are those of the model. Radius of the pulley and size of the spring are not known: they
are chosen to be seen; the pulley turns by what it winds up, the spring stretches by what it does.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.stream.tendon.shape import Shape

Floats = npt.NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
RADIUS, STUB, ROOM, SPRING, WIDE, FOOT = 0.07, 0.03, 0.06, 0.16, 0.024, 0.05  # of the scene's size
SPOKES = 3
WINDINGS = 7
ROUND = 48  # points of a circle


@dataclass(frozen=True)
class Ends:
    """Both ends; where they move, displacements of shape (k,) say how [mm]."""

    mouths: Floats  # of the sheath, at the drive and at the load, shape (2, 3)
    touching: Floats  # where the tendon touches the pulley, shape (3,)
    centre: Floats  # of the pulley, shape (3,)
    tip: Floats  # where the tendon meets the spring at no displacement, shape (3,)
    foot: Floats  # where the spring is held, shape (3,)
    size: float

    @property
    def _radius(self) -> Floats:
        return self.touching - self.centre

    @property
    def rim(self) -> Floats:
        """The pulley, shape (p, 3)."""
        return self._around(np.linspace(0.0, 2.0 * math.pi, ROUND + 1))

    @property
    def anchor(self) -> Floats:
        """What holds the spring, shape (2, 3)."""
        half = FOOT * self.size * self._across
        return np.stack((self.foot - half, self.foot + half))

    @property
    def proximal(self) -> Floats:
        """Free tendon from the pulley to the sheath, shape (2, 3)."""
        return np.stack((self.touching, self.mouths[0]))

    @property
    def names(self) -> Floats:
        """Where drive and load are named, shape (2, 3)."""
        back = (self.touching - self.mouths[0]) / np.linalg.norm(self.touching - self.mouths[0])
        beyond = (self.foot - self.tip) / np.linalg.norm(self.foot - self.tip)
        at_drive = self.touching + (RADIUS + FOOT) * self.size * back
        return np.stack((at_drive, self.foot + FOOT * self.size * beyond))

    def spokes(self, x_in_mm: Floats) -> Floats:
        """Return the pulley's spokes, shape (k, SPOKES, 2, 3)."""
        wound = x_in_mm[:, None] / (RADIUS * self.size)
        angles = wound + 2.0 * math.pi * np.arange(SPOKES) / SPOKES
        ends = self._around(angles)
        return np.stack((np.broadcast_to(self.centre, ends.shape), ends), axis=2)

    def distal(self, x_out_mm: Floats) -> Floats:
        """Return free tendon from the sheath to the spring, shape (k, 2, 3)."""
        tips = self._tips(x_out_mm)
        return np.stack((np.broadcast_to(self.mouths[1], tips.shape), tips), axis=1)

    def spring(self, x_out_mm: Floats) -> Floats:
        """Return the spring, shape (k, p, 3)."""
        turns = np.arange(2 * WINDINGS)
        middle = 0.08 + 0.84 * (turns + 0.5) / turns.size
        share = np.concatenate(([0.0, 0.08], middle, [0.92, 1.0]))[:, None]
        swing = np.concatenate(([0.0, 0.0], (-1.0) ** turns, [0.0, 0.0]))[:, None]
        tips = self._tips(x_out_mm)[:, None]
        return tips + share * (self.foot - tips) + WIDE * self.size * swing * self._across

    @property
    def _across(self) -> Floats:
        return _level(np.cross(self.foot - self.tip, UP))

    def _tips(self, x_out_mm: Floats) -> Floats:
        """Return where the tendon meets the spring: no further than the sheath's mouth."""
        most = float(np.max(np.abs(x_out_mm), initial=0.0))
        room = float(np.linalg.norm(self.tip - self.mouths[1]))
        drawn = x_out_mm * min(1.0, room / most if most > 0.0 else 1.0)
        way = (self.tip - self.foot) / np.linalg.norm(self.tip - self.foot)
        tips: Floats = self.tip + drawn[:, None] * way
        return tips

    def _around(self, angle: Floats) -> Floats:
        """Return places on the rim, from where the tendon touches, in the way that it is wound."""
        along = np.cross(UP, self._radius)  # out of the sheath, where the tendon touches
        turned = np.cos(angle)[..., None] * self._radius + np.sin(angle)[..., None] * along
        place: Floats = self.centre + turned
        return place


def ends_of(shape: Shape, free_mm: tuple[float, float], size: float) -> Ends:
    """Return the ends of a sheath with free tendon at the drive and at the load.

    `size` is that of the scene, which the glyphs are scaled by [mm].
    """
    touching = shape.sheath[0] - shape.into * (free_mm[0] + STUB * size)
    tip = shape.sheath[-1] + shape.out_of * (free_mm[1] + ROOM * size)
    return Ends(
        shape.sheath[[0, -1]],
        touching,
        touching + RADIUS * size * _level(np.cross(shape.into, UP)),
        tip,
        tip + shape.out_of * SPRING * size,
        size,
    )


def _level(across: Floats) -> Floats:
    level: Floats = across / np.linalg.norm(across)
    return level
