"""What is drawn at the ends of the sheath: free tendon, the drive's pulley, the load's spring.

Lengths are those of the model. Radius of the pulley and size of the spring are not known: they
are chosen to be seen; the pulley turns by what it winds up, the spring stretches by what it does.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.tendon.shape import Shape

Floats = npt.NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
SPOKES = 3
WINDINGS = 7
ROUND = 48  # points of a circle


@dataclass(frozen=True)
class Ends:
    """Curves at the ends, over k moments where they move [mm]."""

    proximal: Floats  # free tendon from the pulley to the sheath, shape (2, 3)
    rim: Floats  # of the pulley, shape (p, 3)
    spokes: Floats  # shape (k, SPOKES, 2, 3)
    distal: Floats  # free tendon from the sheath to the spring, shape (k, 2, 3)
    spring: Floats  # shape (k, p, 3)
    anchor: Floats  # shape (2, 3)


def ends_of(
    shape: Shape,
    free_mm: tuple[float, float],
    size_mm: float,
    x_in_mm: Floats,
    x_out_mm: Floats,
) -> Ends:
    """Return the curves.

    Parameters
    ----------
    shape
        The sheath.
    free_mm
        Free tendon at the drive and at the load.
    size_mm
        What the glyphs are scaled by.
    x_in_mm, x_out_mm
        Displacements, positive towards the drive, shape (k,).
    """
    radius, stub = 0.07 * size_mm, 0.03 * size_mm
    mouth = shape.sheath[0]
    tangent = mouth - shape.into * (free_mm[0] + stub)
    side = _level(np.cross(shape.into, UP))
    centre = tangent + side * radius
    along = np.cross(UP, side)
    turned = np.linspace(0.0, 2.0 * math.pi, ROUND + 1)
    rim = centre + radius * _ring(turned, side, along)
    spoke = -x_in_mm[:, None] / radius + 2.0 * math.pi * np.arange(SPOKES) / SPOKES
    spokes = np.empty((*spoke.shape, 2, 3))
    spokes[:, :, 0] = centre
    spokes[:, :, 1] = centre + radius * _ring(spoke, side, along)
    rest = free_mm[1] + stub + float(np.max(x_out_mm, initial=0.0))
    tip = shape.sheath[-1] + shape.out_of * (rest - x_out_mm)[:, None]
    foot = shape.sheath[-1] + shape.out_of * (rest + 0.18 * size_mm)
    across = _level(np.cross(shape.out_of, UP))
    distal = np.stack((np.broadcast_to(shape.sheath[-1], tip.shape), tip), axis=1)
    anchor = np.stack((foot - 0.05 * size_mm * across, foot + 0.05 * size_mm * across))
    return Ends(
        np.stack((tangent, mouth)),
        rim,
        spokes,
        distal,
        _zigzag(tip, foot, 0.024 * size_mm * across),
        anchor,
    )


def _ring(angle: Floats, side: Floats, along: Floats) -> Floats:
    return -np.cos(angle)[..., None] * side + np.sin(angle)[..., None] * along


def _level(across: Floats) -> Floats:
    level: Floats = across / np.linalg.norm(across)
    return level


def _zigzag(tip: Floats, foot: Floats, across: Floats) -> Floats:
    """Return a spring between two places, shape (k, p, 3)."""
    share = np.concatenate(([0.0, 0.08], 0.08 + 0.84 * (np.arange(2 * WINDINGS) + 0.5) / (2 * WINDINGS), [0.92, 1.0]))
    swing = np.concatenate(([0.0, 0.0], (-1.0) ** np.arange(2 * WINDINGS), [0.0, 0.0]))
    return tip[:, None] + share[:, None] * (foot - tip)[:, None] + swing[:, None] * across
