"""Friction in the sheath changes along the stroke of the drive.

What one sees: in f_in over f_out the lines of pull and release open (or close) along the stroke, as
with friction that depends on the tension; but at one tension and another place of the stroke, as
after a change of preload, the friction is another one. It repeats from stroke to stroke.
Equation: Yang 2025, Eq. (7), with μ (1 + slope·x), x the displacement of the tendon's end at the
drive: the first term of a coating, a wear mark or a bend that comes into play with the stroke. The
paper's μ is constant.
Mistaken for: load_dependent_friction (with a load spring tension and place rise together: only
runs at several preloads separate them well); direction_dependent_friction (the same at any place);
friction_drift, bend_drift (with time, not with place).
Not validated: places where the friction would be negative, where it is zero; a drive by a measured
force, along which the friction is that of x = 0.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class PositionDependentFriction(NamedTuple):
    """Relative change of the friction per displacement of the drive [1/mm]."""

    slope_per_mm: float = 0.0


@kernel
def position_factor(position: float, slope_per_mm: float) -> float:
    """Return the factor of the friction coefficient at a position [mm], not below 0."""
    factor: float = np.maximum(1.0 + slope_per_mm * position, 0.0)
    return factor


POSITION_DEPENDENT_FRICTION = Effect(
    name="position_dependent_friction",
    title="Friction that changes along the stroke",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(1 + slope·x)",
    doc=__doc__,
    parameters=(
        Parameter("slope_per_mm", "1/mm", neutral=0.0, start=0.005, lower=-0.5, upper=0.5),
    ),
    experiment="Short strokes about several places of the drive, at each with the anchor of the "
    "load moved so that the tension is the same: ln(f_in/f_out) over the place.",
)
