"""The sheath drags on the tendon with the same force at any tension.

What one sees: f_in is too high on a pull and too low on a release by a force that does not grow
with the tension. Unlike friction at the drive it builds up over the dead band, which is wider and
rounder, and it stretches the tendon: x_out lags too. Grease, liners, seals and a tendon that is
stiff in bending do this, in a straight sheath too.
Equation: Yang 2025, Eq. (2), with a Coulomb friction D per length L beside that of the capstan; not
in the paper. With the bend even along the sheath T + D/(μθ) follows the capstan law, Eq. (7).
Mistaken for: drive_friction (its jump at a reversal is at once, and x_out does not know it);
load_friction (the sheath enlarges it on a pull and reduces it on a release); a larger friction
coefficient, load_dependent_friction (grow or fall with the tension); viscous_friction (grows with
speed); force_sensor_offset of both sensors by −D/(μθ) (indistinguishable at one bend).
Not validated: drag that is not even along the sheath, or not the same in sheaths of other lengths;
a tendon that the drive lets go of for long.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class SheathDrag(NamedTuple):
    """Friction force of the whole sheath that is independent of the tension [N]."""

    force_N: float = 0.0


@kernel
def drag_over(share: float, force: float) -> float:
    """Return the drag of a share of the sheath [N], by that of the whole."""
    return share * force


SHEATH_DRAG = Effect(
    name="sheath_drag",
    title="Drag in the sheath",
    acts_on="tendon",
    closed_form=False,
    equation="dT/ds = −λ·(μκT + D/L)",
    doc=__doc__,
    parameters=(Parameter("force_N", "N", neutral=0.0, start=1.0, lower=0.0, upper=1000.0),),
    experiment="Lay the sheath straight and pull the tendon through it at two preloads: f_in − "
    "f_out while it slides is the drag, the same at both.",
)
