"""Friction is not the same on a pull as on a release.

What one sees: in f_in over f_out the slopes of pull and release are no longer inverse to each
other: with more friction on the pull, f_in is too high in both directions, in proportion to the
tension and to the bend. x_out hardly changes.
Equation: the capstan law of Yang 2025, Eqs. (2) and (7), with a friction coefficient for each
direction λ of sliding; the paper has one.
Mistaken for: force_sensor_gain (in full slip exactly the same within one bend, where only
f_in/f_out is observable; the asymmetry grows with the bend, a gain does not);
force_sensor_offset (the same force at every tension).
Not validated: an asymmetry that changes along the sheath.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class DirectionDependentFriction(NamedTuple):
    """Relative excess of friction on a pull, and its deficit on a release [1]."""

    asymmetry: float = 0.0


@kernel
def direction_factor(asymmetry: float, direction: float) -> float:
    """Return the factor of the friction coefficient; direction +1 contraction, −1 loosening."""
    return 1.0 + asymmetry * direction


DIRECTION_DEPENDENT_FRICTION = Effect(
    name="direction_dependent_friction",
    title="Friction that depends on the direction",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(1 + α λ),  λ = +1 contraction, −1 loosening",
    doc=__doc__,
    parameters=(Parameter("asymmetry", "1", neutral=0.0, start=0.1, lower=-0.9, upper=0.9),),
    experiment="The same strokes at two bends: the product of the two slopes of f_in over f_out "
    "departs from 1 with the bend; with a wrong gain it does not.",
)
