"""The friction coefficient changes with the tension that presses the tendon on its sheath.

What one sees: in f_in over f_out the lines of pull and release are curves. With a positive
exponent the loop opens more than in proportion to the tension, with a negative one less; f_out
over x_out stays straight.
Equation: Yang 2025, Eq. (2), with μ (T/F0)^exponent at each point of the sheath. An elastic
contact, whose area grows as N^(2/3), has −1/3 (Bowden and Tabor); the paper has 0.
Mistaken for: drive_friction, load_friction (straight lines with an intercept: with few tensions
similar to a negative exponent); load_spring_nonlinearity (bends f_out over x_out); a wrong
friction coefficient (in recordings near one tension).
Not validated: tensions below a hundredth of the preload, where the law is clipped.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential, logarithm

SMALLEST_RATIO = 0.01  # below it a negative exponent would let friction grow without limit


class LoadDependentFriction(NamedTuple):
    """Exponent of the friction coefficient over the tension [1]."""

    exponent: float = 0.0


@kernel
def load_factor(tension_ratio: float, exponent: float) -> float:
    """Return the factor of the friction coefficient where the tension is `tension_ratio` F0."""
    return exponential(load_exponent(tension_ratio, exponent))


@kernel
def load_exponent(tension_ratio: float, exponent: float) -> float:
    """Return the logarithm of `load_factor`."""
    return exponent * logarithm(max(abs(tension_ratio), SMALLEST_RATIO))


LOAD_DEPENDENT_FRICTION = Effect(
    name="load_dependent_friction",
    title="Friction coefficient that depends on the tension",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(T/F0)^n",
    doc=__doc__,
    parameters=(Parameter("exponent", "1", neutral=0.0, start=0.2, lower=-1.5, upper=1.5),),
    experiment="The same strokes at preloads far apart: ln(f_in/f_out) in full slip over the "
    "tension.",
)
