"""The mass of the load needs a force where it accelerates.

What one sees: f_out over x_out departs from the spring's line with the acceleration: short peaks in
f_out and f_in where the load starts to move at the end of a dead band, and in fast sines a spring
that looks softer by m ω². Slow runs fit.
Equation: Newton's second law; 1 kg times 1 mm/s² is 1e-3 N. Yang 2025, Eqs. (11) and (12), neglect
the mass of the load.
Mistaken for: a softer load spring (in runs of one frequency); viscous_friction, channel_delay
(proportional to the speed); noise of x_out, whose second derivative is large.
Not validated: loads that swing or bounce; the mass of the tendon itself.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel

N_PER_KG_MM_S2 = 1e-3


class LoadInertia(NamedTuple):
    """Mass that moves with x_out [kg]."""

    mass_kg: float = 0.0


@kernel
def inertia_force(acceleration_mm_s2: float, mass_kg: float) -> float:
    """Return the force that accelerates the load [N]."""
    return N_PER_KG_MM_S2 * mass_kg * acceleration_mm_s2


LOAD_INERTIA = Effect(
    name="load_inertia",
    title="Mass of the load",
    acts_on="load",
    closed_form=False,
    equation="f_out = spring force + m·a_out",
    doc=__doc__,
    parameters=(Parameter("mass_kg", "kg", neutral=0.0, start=1.0, lower=0.0, upper=1000.0),),
    experiment="Sines of the same stroke at rising frequency: the slope of f_out over x_out falls "
    "with the frequency squared.",
)
