"""The load spring gets stiffer or softer along its travel.

What one sees: f_out over x_out is a curve, the same one on pull and release; f_in follows it in
proportion. The residual of a straight line is a bow (quadratic) or an S (cubic) over the stroke.
Equation: a polynomial in place of the straight spring of Yang 2025, Eq. (9).
Mistaken for: load_dependent_friction (bends f_in over f_out; f_out over x_out stays straight);
load_friction (a loop, not one curve); force_sensor_curvature (x_out and f_in fit); load_ripple (a
wave, where the stroke is long); position_sensor_gain, a wrong spring stiffness (a slope, not a
curve).
Not validated: travel outside the recorded range, where a polynomial may even fall.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class LoadSpringNonlinearity(NamedTuple):
    """Change of the spring's stiffness with travel [1/mm] and with its square [1/mm²]."""

    quadratic_per_mm: float = 0.0
    cubic_per_mm2: float = 0.0


@kernel
def spring_force(position: float, stiffness: float, shape: LoadSpringNonlinearity) -> float:
    """Return the spring's force above the preload [N] at a position of the load [mm]."""
    share = shape.quadratic_per_mm * position + shape.cubic_per_mm2 * position * position
    return stiffness * position * (1.0 + share)


@kernel
def spring_tangent(position: float, stiffness: float, shape: LoadSpringNonlinearity) -> float:
    """Return the slope of `spring_force` over the position [N/mm]."""
    share = (
        2.0 * shape.quadratic_per_mm * position + 3.0 * shape.cubic_per_mm2 * position * position
    )
    return stiffness * (1.0 + share)


LOAD_SPRING_NONLINEARITY = Effect(
    name="load_spring_nonlinearity",
    title="Nonlinear load spring",
    acts_on="load",
    closed_form=False,
    equation="spring force = F0 + kL·x·(1 + q x + c x²)",
    doc=__doc__,
    parameters=(
        Parameter("quadratic_per_mm", "1/mm", neutral=0.0, start=0.01, lower=-1.0, upper=1.0),
        Parameter("cubic_per_mm2", "1/mm²", neutral=0.0, start=0.0005, lower=-1.0, upper=1.0),
    ),
    experiment="Pull the load spring by itself over its whole travel and record force and travel.",
)
