"""A lubricant opposes the tendon with a force that grows with its speed.

What one sees: f_in is too high on a pull and too low on a release, in proportion to the speed and
independent of the tension; with a sine as input the loop of f_in over x_in is too wide in the
middle of the stroke and fits at its ends. Slow runs fit, fast ones do not.
Equation: the σ2 v term of Yang 2025, Eq. (15), summed over the sheath: Table 1's 4e-4 N s/mm for
each of 50 lumps make c = 0.02 N s/mm. v is the sliding speed of the drive's end.
Mistaken for: drive_friction, a larger friction coefficient (indistinguishable at one speed; they do
not grow with it); stribeck_friction (less friction when fast); channel_delay (also in dead bands,
where f_in is steep); load_inertia (proportional to the acceleration).
Not validated: lubricants that thin with speed or temperature; points of the tendon that slide
slower than the drive's end; a tendon that the drive lets go of for long.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class ViscousFriction(NamedTuple):
    """Tension lost over the whole sheath per sliding speed [N s/mm]."""

    coefficient_N_s_per_mm: float = 0.0


@kernel
def viscous_loss(speed: float, coefficient: float) -> float:
    """Return the tension lost over the whole sheath [N] at a sliding speed [mm/s]."""
    magnitude: float = np.abs(speed)
    return coefficient * magnitude


VISCOUS_FRICTION = Effect(
    name="viscous_friction",
    title="Friction that grows with speed",
    acts_on="tendon",
    closed_form=False,
    equation="dT/ds = −λ·(μκT + c|v|/L)",
    doc=__doc__,
    parameters=(
        Parameter(
            "coefficient_N_s_per_mm", "N s/mm", neutral=0.0, start=0.02, lower=0.0, upper=100.0
        ),
    ),
    experiment="The same stroke at constant speeds, each twice the last: f_in at one position of "
    "the stroke rises in proportion to the speed.",
)
