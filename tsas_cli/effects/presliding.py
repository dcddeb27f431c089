"""Where the tendon sticks, friction turns round over a small elastic travel and not at once.

What one sees: after a reversal f_in leaves with a finite slope instead of a sharp corner; f_out and
x_out set off gently, and the whole tendon slides later by twice the same travel, at low tension as
at high. Strokes below that travel are lines without a loop.
Equation: the bristle of Yang 2025, Eq. (15), as a spring: friction changes by (its limit/length)
per mm of motion, up to the limit.
Mistaken for: backlash (a flat piece first); drive_compliance, free_tendon (longer at higher
tension); stribeck_friction (goes with speed); x_in smoothed too much before the fit, which rounds
the same corners.
Not validated: bristles that yield gradually, as Dahl's do; a length that depends on the tension.
"""

import math
from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class Presliding(NamedTuple):
    """Travel over which friction grows from nothing to its limit [mm]."""

    length_mm: float = 0.0


@kernel
def bristle_stiffness(limit: float, length: float) -> float:
    """Return friction per travel [N/mm] where its limit is `limit` [N]; infinite for length 0."""
    return limit / length if length > 0.0 else math.inf


PRESLIDING = Effect(
    name="presliding",
    title="Elastic travel before sliding",
    acts_on="tendon",
    equation="df/dx = limit/length while |f| < limit",
    doc=__doc__,
    parameters=(
        Parameter(
            "length_mm", "mm", neutral=0.0, start=0.02, lower=0.0, upper=20.0, starts=(0.005, 0.05)
        ),
    ),
    experiment="Strokes that shrink from 1 mm to a hundredth about one tension: below the length "
    "the loop of f_in over x_in closes into a line.",
)
