"""The friction coefficient changes with the tension that presses the tendon on its sheath.

What one sees: in f_in over f_out the lines of pull and release are curves. With a positive
exponent the loop opens more than in proportion to the tension, with a negative one less; f_out
over x_out stays straight.
Equation: Yang 2025, Eq. (2), with μ (T/10 N)^exponent at each point of the sheath, whatever the
preload: the friction coefficient is that at 10 N. An elastic contact, whose area grows as
N^(2/3), has −1/3 (Bowden and Tabor); the paper has 0.
Mistaken for: drive_friction, load_friction (straight lines with an intercept: with few tensions
similar to a negative exponent); load_spring_nonlinearity (bends f_out over x_out); a wrong
friction coefficient (in recordings near one tension).
Not validated: tensions below 0.1 N, where the law is clipped.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential, logarithm

AT_N = 10.0  # tension at which the friction coefficient is the stated one
LEAST_N = 0.1  # below it a negative exponent would let friction grow without limit


class LoadDependentFriction(NamedTuple):
    """Exponent of the friction coefficient over the tension [1]."""

    exponent: float = 0.0


@kernel
def load_factor(tension_N: float, exponent: float) -> float:
    """Return the factor of the friction coefficient at a tension [N]."""
    return exponential(load_exponent(tension_N, exponent))


@kernel
def load_exponent(tension_N: float, exponent: float) -> float:
    """Return the logarithm of `load_factor`."""
    return exponent * logarithm(max(abs(tension_N), LEAST_N) / AT_N)


LOAD_DEPENDENT_FRICTION = Effect(
    name="load_dependent_friction",
    title="Friction coefficient that depends on the tension",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(T/10 N)^n",
    doc=__doc__,
    parameters=(Parameter("exponent", "1", neutral=0.0, start=0.05, lower=-1.5, upper=1.5),),
    experiment="The same strokes at preloads far apart: ln(f_in/f_out) in full slip over the "
    "tension.",
)
