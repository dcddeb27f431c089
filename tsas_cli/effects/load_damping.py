"""Beside the load spring a damper opposes the load.

What one sees: f_out over x_out is a loop that is wide where the load is fast and closed where it
stands still, with a height in proportion to the speed; f_in has it too, more on a pull than on a
release. Slow runs fit.
Equation: Newton's law of friction c v parallel to the spring of Yang 2025, Eq. (9), v the speed of
x_out. The sheath transmits it like the load. The paper's load has no damper.
Mistaken for: load_friction (a loop of constant height, which does not grow with the speed);
viscous_friction (f_out over x_out stays a line); channel_delay, sensor_lag of f_out or x_out (the
same loop, without any effect on f_in); load_relaxation (its loop closes in fast motion).
Not validated: air dampers, whose force is not proportional to the speed; a slack tendon, whose
load returns at once.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class LoadDamping(NamedTuple):
    """Force of the damper per speed of the load [N s/mm]."""

    coefficient_N_s_per_mm: float = 0.0


@kernel
def load_damper_force(speed: float, coefficient: float) -> float:
    """Return the force of the damper at the load [N], added to the spring's; speed in mm/s."""
    return coefficient * speed


LOAD_DAMPING = Effect(
    name="load_damping",
    title="Damping of the load",
    acts_on="load",
    closed_form=False,
    equation="f_out = spring force + c·v_out",
    doc=__doc__,
    parameters=(
        Parameter(
            "coefficient_N_s_per_mm", "N s/mm", neutral=0.0, start=0.05, lower=0.0, upper=100.0
        ),
    ),
    experiment="The same stroke at speeds that double: the height of the loop of f_out over x_out "
    "doubles with them.",
)
