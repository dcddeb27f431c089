"""Where the tendon sticks, friction reverses over a small travel and not at once.

What one sees: after a reversal f_in changes with a finite slope instead of a sharp corner; f_out
and x_out start smoothly, and the whole tendon slides later by about twice the travel. Strokes far
below that travel are lines without a loop.
Equation: the quasi-static bristles of Yang 2025, Eq. (15): the ratio z of friction to its limit
follows dz/dx = (1 − z sgn(dx))/length (P. R. Dahl, AIAA Journal 14, 1976). Where the stiffness of
the bristles grows with the tension, as that of asperities, the length is the same at any; where it
is fixed, as in Eq. (15), the length is the limit of friction over it. A part may be of either kind.
Mistaken for: backlash (a flat piece first); drive_compliance, free_tendon (the whole tendon moves
on at once); stribeck_friction (depends on speed); x_in smoothed too much before the fit, which
rounds the same corners.
Not validated: bristles that yield all at once at their limit.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential

AT_N = 10.0  # tension at which the travel is stated


class Presliding(NamedTuple):
    """Travel over which friction comes within 1/e of its limit at 10 N [mm], and its growth.

    `growth` is the part of the travel that is in proportion to the limit of friction [1].
    """

    length_mm: float = 0.0
    growth: float = 0.0


@kernel
def fixed_travel(presliding: Presliding) -> float:
    """Return the travel that is the same at any tension [mm]."""
    return presliding.length_mm * (1.0 - presliding.growth)


def travel_at(tension_N: float, presliding: Presliding) -> float:
    """Return the travel at a tension of a tendon without drag [mm]."""
    growing = presliding.length_mm * presliding.growth
    return fixed_travel(presliding) + growing * tension_N / AT_N


@kernel
def bristle_compliance(presliding: Presliding, wrap: float) -> float:
    """Return the compliance of the bristles of fixed stiffness [mm/N], at friction times bend."""
    if wrap == 0.0:
        return 0.0
    return presliding.length_mm * presliding.growth / (AT_N * wrap)


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
    equation="dz/dx = (1 − z·sgn(dx))/l, friction = z·limit, "
    "l = length·(1 − growth + growth·limit/limit at 10 N)",
    doc=__doc__,
    parameters=(
        Parameter(
            "length_mm", "mm", neutral=0.0, start=0.02, lower=0.0, upper=20.0, starts=(0.005, 0.05)
        ),
        Parameter("growth", "1", 0.0, 0.5, 0.0, 1.0, shape=True, starts=(0.0,)),
    ),
    experiment="Strokes that shrink from 1 mm to a hundredth about one tension: below the length "
    "the loop of f_in over x_in closes into a line.",
)
