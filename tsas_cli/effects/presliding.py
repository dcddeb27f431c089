"""Where the tendon sticks, friction reverses over a small travel and not at once.

What one sees: after a reversal f_in changes with a finite slope instead of a sharp corner; f_out
and x_out start smoothly, and the whole tendon slides later by about twice the travel, at low
tension as at high. Strokes far below that travel are lines without a loop.
Equation: the quasi-static bristles of Yang 2025, Eq. (15): the ratio z of friction to its limit
follows dz/dx = (1 − z sgn(dx))/length (P. R. Dahl, AIAA Journal 14, 1976).
Mistaken for: backlash (a flat piece first); drive_compliance, free_tendon (longer at higher
tension); stribeck_friction (depends on speed); x_in smoothed too much before the fit, which rounds
the same corners.
Not validated: bristles that yield all at once at their limit; a length that depends on the tension.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential


class Presliding(NamedTuple):
    """Travel over which friction comes within 1/e of its limit [mm]."""

    length_mm: float = 0.0


@kernel
def friction_share(before: float, moved: float, length: float) -> float:
    """Return the ratio of friction to its limit after a travel of one sign [1]."""
    limit = 1.0 if moved > 0.0 else -1.0
    if length == 0.0:
        return limit
    per_mm = 1.0 / length  # hoisted out of loops over nodes
    return limit + (before - limit) * exponential(-abs(moved) * per_mm)


@kernel
def friction_share_rate(share: float, moved: float, length: float) -> float:
    """Return d share/d travel after a travel [1/mm]; at zero travel the steeper of both sides."""
    if moved == 0.0:
        return (1.0 + abs(share)) / length
    return (1.0 - share if moved > 0.0 else 1.0 + share) / length


PRESLIDING = Effect(
    name="presliding",
    title="Elastic travel before sliding",
    acts_on="tendon",
    closed_form=False,
    equation="dz/dx = (1 − z·sgn(dx))/length, friction = z·limit",
    doc=__doc__,
    parameters=(
        Parameter(
            "length_mm", "mm", neutral=0.0, start=0.02, lower=0.0, upper=20.0, starts=(0.005, 0.05)
        ),
    ),
    experiment="Strokes that shrink from 1 mm to a hundredth about one tension: below the length "
    "the loop of f_in over x_in closes into a line.",
)
