"""Beside the load spring an elastoplastic element follows the load and yields.

What one sees: f_out over x_out is a loop of constant height that closes over a travel: after each
reversal of the load f_out first follows a steeper line and then one in parallel to the spring's, at
any speed. f_in has it too, more on a pull than on a release. Strokes below twice the travel are
lines of a stiffer spring.
Equation: the force z of a spring in series with a Coulomb slider (Prandtl), parallel to the spring
of Yang 2025, Eq. (9): dz = force/travel dx as long as |z| is below the force; the inner friction of
rubber, foam, textiles and soft tissue. The paper's load has none.
Mistaken for: load_friction (at once at full height: a travel of nothing, over which x_out stands
still); load_damping (grows with the speed); force_sensor_hysteresis (the opposite sense, by a span
of force).
Not validated: more than one element, as in materials whose loops have a continuous curve; the state
of the element before a run, which is taken to be without force.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter, shape
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.stops import yielded


class LoadHysteresis(NamedTuple):
    """Force at which the element yields [N], and the travel from zero to there [mm]."""

    force_N: float = 0.0
    travel_mm: float = 0.5


@kernel
def element_force(before: float, moved: float, law: LoadHysteresis) -> tuple[float, float]:
    """Return the element's force after a motion of the load [N], and its slope [N/mm]."""
    stiffness = law.force_N / law.travel_mm
    followed = before + stiffness * moved
    force = yielded(before, stiffness * moved, law.force_N)
    return force, stiffness if force == followed else 0.0


LOAD_HYSTERESIS = Effect(
    name="load_hysteresis",
    title="Hysteresis of the load",
    acts_on="load",
    closed_form=False,
    equation="f_out = spring force + z,  dz = force/travel·dx_out while |z| < force",
    doc=__doc__,
    parameters=(
        Parameter("force_N", "N", neutral=0.0, start=0.5, lower=0.0, upper=1000.0),
        shape("travel_mm", "mm", 0.5, lower=0.001, upper=100.0, starts=(0.1, 0.5, 2.0)),
    ),
    experiment="Remove the tendon and pull the load slowly back and forth by strokes that grow: "
    "from twice the travel on the loop opens, and grows no higher.",
)
