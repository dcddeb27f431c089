"""Friction between the drive's force sensor and the tendon has the same force at any tension.

What one sees: f_in jumps by twice the friction at every reversal of x_in, up when a pull begins
and down when a release begins, as high at low tension as at high; f_out and x_out are unaffected.
f_in over f_out is wider by a constant, its two slopes are unchanged.
Equation: Coulomb friction independent of the tension T0 behind it: an intercept added to the
capstan law of Yang 2025, Eq. (7). Not in the paper.
Mistaken for: a larger friction coefficient (its share grows with tension); sheath_drag (builds up
over the dead band, and x_out knows it); load_friction (the sheath enlarges it on a pull and reduces
it on a release); viscous_friction, drive_damping (grow with speed); force_sensor_offset (the same
sign in both directions).
Not validated: a drive at rest: the friction keeps the sign of the last motion.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class DriveFriction(NamedTuple):
    """Friction force at the drive [N]."""

    friction_N: float = 0.0


@kernel
def drive_friction_force(friction: float, direction: float) -> float:
    """Return the friction added to the tension at the drive [N]; direction +1, −1, or 0."""
    return friction * direction


DRIVE_FRICTION = Effect(
    name="drive_friction",
    title="Friction at the drive",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T0 + Fc · sgn(v)",
    doc=__doc__,
    parameters=(Parameter("friction_N", "N", neutral=0.0, start=1.0, lower=0.0, upper=1000.0),),
    experiment="The same strokes at two preloads: the jump of f_in at a reversal is as high at "
    "both.",
)
